//! What the harness itself executes around a tick: fetching the arguments that a control task has at hand.

use core::mem::MaybeUninit;

use controller_core::error::StepFault;
use controller_core::maths::Single;
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::report::StepReport;
use controller_core::types::Measured;
use firmware_demo::board::Meter;

type Controller = NeuralController<f32, Single>;
type Answer<'a> = Result<&'a StepReport<f32>, StepFault>;

/// Takes what a tick takes, in the same registers, and returns at once: one instruction.
#[allow(unsafe_code)]
#[unsafe(naked)]
extern "C" fn nothing(
    _answer: &mut MaybeUninit<Answer<'_>>,
    _controller: &mut Controller,
    _dt: f32,
    _demand: &Demand<f32>,
    _now: &Measured<f32>,
) {
    #[cfg(target_arch = "arm")]
    core::arch::naked_asm!("bx lr");
    #[cfg(target_arch = "riscv32")]
    core::arch::naked_asm!("ret");
}

/// Instructions to take off a measured tick, so that its call and its own instructions are left.
#[inline(never)]
pub fn overhead(
    meter: &mut Meter,
    controller: &mut Controller,
    dt: f32,
    demand: &Demand<f32>,
    now: &Measured<f32>,
) -> u32 {
    let measured = meter
        .measure(move || {
            let mut answer = MaybeUninit::uninit();
            nothing(&mut answer, controller, dt, demand, now);
        })
        .1;
    // Its call and its return are not overhead: the tick's are counted.
    measured.saturating_sub(2)
}
