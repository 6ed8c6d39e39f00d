//! `virt`: the CLINT's machine timer at 10 MHz.

use core::arch::asm;
use core::ptr::{read_volatile, write_volatile};

const CLINT: usize = 0x0200_0000;
const COMPARE_LOW: usize = CLINT + 0x4000;
const COMPARE_HIGH: usize = CLINT + 0x4004;
const TIME_LOW: usize = CLINT + 0xBFF8;
const TIME_HIGH: usize = CLINT + 0xBFFC;
const MACHINE_TIMER: usize = 1 << 7;
const MACHINE_INTERRUPTS: usize = 1 << 3;

/// Of the clock that tells the time.
pub const COUNTS_PER_US: u32 = 10;

/// The machine timer.
pub struct Timer {
    next: u64,
    period: u64,
}

impl Timer {
    /// The first interrupt is due in a period, and off.
    pub fn new(period_us: u32) -> Self {
        let period = u64::from(period_us) * u64::from(COUNTS_PER_US);
        let timer = Self {
            next: time().wrapping_add(period),
            period,
        };
        timer.arm();
        timer
    }

    /// Time in counts, wraps around.
    pub fn counts(&self) -> u32 {
        load(TIME_LOW)
    }

    /// Sets the next instant; periods that were missed altogether are left out.
    pub fn acknowledge(&mut self) {
        self.next = self.next.wrapping_add(self.period);
        let now = time();
        if self.next <= now {
            self.next = now.wrapping_add(self.period);
        }
        self.arm();
    }

    /// Lets the interrupt through.
    pub fn enable() {
        // SAFETY: the handler is there and its state is set.
        unsafe {
            asm!("csrs mie, {}", in(reg) MACHINE_TIMER, options(nostack));
            asm!("csrs mstatus, {}", in(reg) MACHINE_INTERRUPTS, options(nostack));
        }
    }

    /// Holds the interrupt back.
    pub fn disable() {
        // SAFETY: switching an interrupt off runs no code.
        unsafe { asm!("csrc mie, {}", in(reg) MACHINE_TIMER, options(nostack)) };
    }

    fn arm(&self) {
        // High first, at its largest, so that no instant in between is in the past.
        store(COMPARE_HIGH, u32::MAX);
        store(COMPARE_LOW, self.next as u32);
        store(COMPARE_HIGH, (self.next >> 32) as u32);
    }
}

fn time() -> u64 {
    let (before, low, after) = (load(TIME_HIGH), load(TIME_LOW), load(TIME_HIGH));
    // The low half has just wrapped when the high halves differ; the later instant is then its start.
    let low = if before == after { low } else { 0 };
    u64::from(after) << 32 | u64::from(low)
}

fn load(register: usize) -> u32 {
    // SAFETY: called with the addresses above only, which are device registers of this board.
    unsafe { read_volatile(register as *const u32) }
}

fn store(register: usize, value: u32) {
    // SAFETY: as `load`; the CLINT reaches no memory.
    unsafe { write_volatile(register as *mut u32, value) };
}

/// Makes the machine timer's interrupt of this binary the one of
/// [`board::with_ticks`](crate::board::with_ticks).
///
/// The run-time crate saves integer registers only; a tick that computes in floating point has to leave those
/// of the background as they were.
#[macro_export]
macro_rules! timer_interrupt {
    () => {
        #[unsafe(no_mangle)]
        #[allow(unsafe_code)]
        extern "C" fn timer_tick() {
            $crate::board::interrupt();
        }

        core::arch::global_asm!(
            // The assembler does not take the target's extensions from the compiler here.
            ".option push",
            ".option arch, +f",
            ".global MachineTimer",
            "MachineTimer:",
            "addi sp, sp, -96",
            "fsw ft0, 0(sp)",
            "fsw ft1, 4(sp)",
            "fsw ft2, 8(sp)",
            "fsw ft3, 12(sp)",
            "fsw ft4, 16(sp)",
            "fsw ft5, 20(sp)",
            "fsw ft6, 24(sp)",
            "fsw ft7, 28(sp)",
            "fsw ft8, 32(sp)",
            "fsw ft9, 36(sp)",
            "fsw ft10, 40(sp)",
            "fsw ft11, 44(sp)",
            "fsw fa0, 48(sp)",
            "fsw fa1, 52(sp)",
            "fsw fa2, 56(sp)",
            "fsw fa3, 60(sp)",
            "fsw fa4, 64(sp)",
            "fsw fa5, 68(sp)",
            "fsw fa6, 72(sp)",
            "fsw fa7, 76(sp)",
            "frcsr t0",
            "sw t0, 80(sp)",
            "sw ra, 84(sp)",
            "call timer_tick",
            "lw ra, 84(sp)",
            "lw t0, 80(sp)",
            "fscsr t0",
            "flw ft0, 0(sp)",
            "flw ft1, 4(sp)",
            "flw ft2, 8(sp)",
            "flw ft3, 12(sp)",
            "flw ft4, 16(sp)",
            "flw ft5, 20(sp)",
            "flw ft6, 24(sp)",
            "flw ft7, 28(sp)",
            "flw ft8, 32(sp)",
            "flw ft9, 36(sp)",
            "flw ft10, 40(sp)",
            "flw ft11, 44(sp)",
            "flw fa0, 48(sp)",
            "flw fa1, 52(sp)",
            "flw fa2, 56(sp)",
            "flw fa3, 60(sp)",
            "flw fa4, 64(sp)",
            "flw fa5, 68(sp)",
            "flw fa6, 72(sp)",
            "flw fa7, 76(sp)",
            "addi sp, sp, 96",
            "ret",
            ".option pop",
        );
    };
}
