//! Encoders, counted by a program in the programmable input and output (PIO): one state machine for each wheel.
//!
//! The program samples both channels some ten million times a second and counts every edge in `y`. The last sample and
//! the new one make a number of four bits, which is the address it jumps to.

use board_common::{ErrorKind, ErrorType, WheelCounts, WheelEncoders};
use pio::pio_asm;
use rp_pac::PIO0;

use crate::pins::{Function, connect};

/// Counts that the queue of a state machine may hold from before it is asked.
const STALE: u8 = 4;
/// Looks at the queue before a counter is given up; a count takes a tenth of a microsecond.
const PATIENCE: u32 = 2000;

/// State machines.
const RIGHT: usize = 0;
const LEFT: usize = 1;

/// Both wheels.
pub struct Encoders(());

impl Encoders {
    /// Counts from 0; each wheel has its channel A on the pin named here, and B on the next one.
    pub fn start<
        const RIGHT_A: usize,
        const RIGHT_B: usize,
        const LEFT_A: usize,
        const LEFT_B: usize,
    >() -> Self {
        const { assert!(RIGHT_B == RIGHT_A + 1 && LEFT_B == LEFT_A + 1 && LEFT_B < 32) };
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
        for (place, instruction) in (0..32).zip(&assembled.program.code) {
            PIO0.instr_mem(place)
                .write(|w| w.set_instr_mem(*instruction));
        }
        // Many encoders only pull down.
        connect::<RIGHT_A>(Function::Pio0, true);
        connect::<RIGHT_B>(Function::Pio0, true);
        connect::<LEFT_A>(Function::Pio0, true);
        connect::<LEFT_B>(Function::Pio0, true);
        set_up::<RIGHT, RIGHT_A>();
        set_up::<LEFT, LEFT_A>();
        PIO0.ctrl()
            .modify(|w| w.set_sm_enable(1 << RIGHT | 1 << LEFT));
        Self(())
    }
}

/// A state machine that samples `A` and the pin after it, at the system clock, from address 0.
fn set_up<const MACHINE: usize, const A: usize>() {
    let machine = PIO0.sm(MACHINE);
    machine.clkdiv().write(|w| w.set_int(1));
    machine.execctrl().write(|w| {
        w.set_wrap_bottom(0);
        w.set_wrap_top(31);
    });
    machine.shiftctrl().write(|w| {
        // Into the input register from the right, out of the output register to the right, 32 bits each.
        w.set_in_shiftdir(false);
        w.set_out_shiftdir(true);
        w.set_in_count(2);
    });
    machine.pinctrl().write(|w| w.set_in_base(A as u8));
    // `jmp 0`, and it does not wait for being enabled.
    machine.instr().write(|w| w.set_instr(0));
}

/// The present count: what the queue held before is passed over. Where counting began is of no matter, the odometry
/// takes differences.
fn count<const MACHINE: usize>() -> Result<i32, ErrorKind> {
    let queue = PIO0.rxf(MACHINE);
    let mut seen = 0;
    for _ in 0..PATIENCE {
        if PIO0.fstat().read().rxempty() & 1 << MACHINE != 0 {
            continue;
        }
        let count = queue.read();
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
            right: count::<RIGHT>()?,
            left: count::<LEFT>()?,
        })
    }
}
