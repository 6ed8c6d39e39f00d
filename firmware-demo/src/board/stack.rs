//! How deep the stack got: painted at the start, looked at later.

use core::arch::asm;
use core::ptr::{addr_of, read_volatile, write_volatile};

const PAINT: u32 = 0xA5C3_3C5A;
/// Painted bytes below the top of the stack. The memory below belongs to nobody on either board.
const PAINTED: usize = 64 * 1024;
/// Kept free below the stack pointer while painting, for the frames of the painter itself.
const MARGIN: usize = 256;

unsafe extern "C" {
    /// First address above the stack, from the linker script of the run-time crate.
    static _stack_start: u32;
}

fn top() -> usize {
    addr_of!(_stack_start) as usize
}

/// Paints the unused stack. What is in use already counts as used, with a margin of 256 bytes.
#[inline(never)]
pub fn paint() {
    let stack_pointer: usize;
    // SAFETY: reads a register.
    unsafe {
        #[cfg(target_arch = "arm")]
        asm!("mov {}, sp", out(reg) stack_pointer, options(nomem, nostack));
        #[cfg(target_arch = "riscv32")]
        asm!("mv {}, sp", out(reg) stack_pointer, options(nomem, nostack));
    }
    let mut at = top().wrapping_sub(PAINTED) & !3;
    while at < stack_pointer.wrapping_sub(MARGIN) {
        // SAFETY: RAM below the live stack, above all statics (the images use a few kB of 256 kB and more).
        unsafe { write_volatile(at as *mut u32, PAINT) };
        at = at.wrapping_add(4);
    }
}

/// The most bytes of stack in use since [`paint`]; 64 kB and more reads as 64 kB.
pub fn high_water_mark() -> u32 {
    let mut at = top().wrapping_sub(PAINTED) & !3;
    // SAFETY: RAM between the statics and the top of the stack, aligned; only read.
    while at < top() && unsafe { read_volatile(at as *const u32) } == PAINT {
        at = at.wrapping_add(4);
    }
    top().wrapping_sub(at) as u32
}
