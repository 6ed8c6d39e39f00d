//! Encoders, counted by a program in the programmable input and output (PIO): one state machine for each wheel.
//!
//! The program samples both channels some ten million times a second and counts every edge in `y`. The last sample and
//! the new one make a number of four bits, which is the address it jumps to.

use board_common::{ErrorKind, ErrorType, WheelCounts, WheelEncoders};
use embassy_rp::gpio::Pull;
use embassy_rp::peripherals::PIO0;
use embassy_rp::pio::program::pio_asm;
use embassy_rp::pio::{
    Common, Config, Direction, InterruptHandler, LoadedProgram, Pio, PioPin, ShiftDirection,
    StateMachine,
};
use embassy_rp::{Peri, bind_interrupts};

/// Counts that the queue of a state machine may hold from before it is asked.
const STALE: u8 = 4;
/// Looks at the queue before a counter is given up; a count takes a tenth of a microsecond.
const PATIENCE: u32 = 2000;

bind_interrupts!(struct Interrupts {
    PIO0_IRQ_0 => InterruptHandler<PIO0>;
});

/// Both wheels.
pub struct Encoders {
    right: StateMachine<'static, PIO0, 0>,
    left: StateMachine<'static, PIO0, 1>,
    /// Dropping it would stop the machines.
    _common: Common<'static, PIO0>,
}

impl Encoders {
    /// Counts from 0; of each pair channel A comes first, and B is the next pin.
    pub fn start(
        pio: Peri<'static, PIO0>,
        right: (Peri<'static, impl PioPin>, Peri<'static, impl PioPin>),
        left: (Peri<'static, impl PioPin>, Peri<'static, impl PioPin>),
    ) -> Self {
        let Pio {
            mut common,
            sm0,
            sm1,
            ..
        } = Pio::new(pio, Interrupts);
        // At address 0, for it computes where it jumps to: by the last sample (B, A) and the new one. A before B is
        // forward: 00, 01, 11, 10. Where both changed at once an edge was missed, and its direction is unknown.
        let assembled = pio_asm!(
            ".origin 0",
            "    jmp report", // 00 00
            "    jmp forth",  // 00 01
            "    jmp back",   // 00 10
            "    jmp report", // 00 11
            "    jmp back",   // 01 00
            "    jmp report", // 01 01
            "    jmp report", // 01 10
            "    jmp forth",  // 01 11
            "    jmp forth",  // 10 00
            "    jmp report", // 10 01
            "    jmp report", // 10 10
            "    jmp back",   // 10 11
            "    jmp report", // 11 00
            "    jmp back",   // 11 01
            "    jmp forth",  // 11 10
            "    jmp report", // 11 11
            // y + 1 is the complement of (the complement of y) - 1.
            "forth:",
            "    mov y, ~y",
            "    jmp y--, less",
            "less:",
            "    mov y, ~y",
            "    jmp report",
            // Goes on below whether y was 0 or not.
            "back:",
            "    jmp y--, report",
            "report:",
            "    mov isr, y",
            // Does not wait for room: the next count is a sample away.
            "    push noblock",
            "    mov isr, x",
            "    in pins, 2",
            "    mov osr, isr",
            "    out x, 2",
            "    mov pc, isr",
        );
        let program = common.load_program(&assembled.program);
        Self {
            right: machine(&mut common, sm0, &program, right),
            left: machine(&mut common, sm1, &program, left),
            _common: common,
        }
    }
}

fn machine<const N: usize>(
    common: &mut Common<'static, PIO0>,
    mut machine: StateMachine<'static, PIO0, N>,
    program: &LoadedProgram<'static, PIO0>,
    (a, b): (Peri<'static, impl PioPin>, Peri<'static, impl PioPin>),
) -> StateMachine<'static, PIO0, N> {
    let (mut a, mut b) = (common.make_pio_pin(a), common.make_pio_pin(b));
    // Many encoders only pull down.
    a.set_pull(Pull::Up);
    b.set_pull(Pull::Up);
    machine.set_pin_dirs(Direction::In, &[&a, &b]);
    let mut config = Config::default();
    config.use_program(program, &[]);
    config.set_in_pins(&[&a, &b]);
    config.shift_in.direction = ShiftDirection::Left;
    config.shift_out.direction = ShiftDirection::Right;
    machine.set_config(&config);
    machine.set_enable(true);
    machine
}

/// The present count: what the queue held before is passed over. Where counting began is of no matter, the odometry
/// takes differences.
fn count<const N: usize>(machine: &mut StateMachine<'static, PIO0, N>) -> Result<i32, ErrorKind> {
    let mut seen = 0;
    for _ in 0..PATIENCE {
        let Some(count) = machine.rx().try_pull() else {
            continue;
        };
        if seen == STALE {
            return Ok(count as i32);
        }
        seen += 1;
    }
    Err(ErrorKind::Bus)
}

impl ErrorType for Encoders {
    type Error = ErrorKind;
}

impl WheelEncoders for Encoders {
    fn counts(&mut self) -> Result<WheelCounts, ErrorKind> {
        Ok(WheelCounts {
            right: count(&mut self.right)?,
            left: count(&mut self.left)?,
        })
    }
}
