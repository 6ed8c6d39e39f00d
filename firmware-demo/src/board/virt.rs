//! `virt`: riscv32imafc, ns16550 UART, `minstret` as instruction counter.

use core::arch::asm;
use core::ptr::{read_volatile, write_volatile};

use embedded_io::{ErrorType, Read, Write};

use super::LinkError;

const UART0: usize = 0x1000_0000;
const DATA: usize = UART0;
const INTERRUPT_ENABLE: usize = UART0 + 1;
const LINE_STATUS: usize = UART0 + 5;
const RECEIVED: u8 = 1;
const TRANSMIT_EMPTY: u8 = 1 << 5;

const PLIC: usize = 0x0C00_0000;
const UART_SOURCE: usize = 10;
const PRIORITY: usize = PLIC + 4 * UART_SOURCE;
const ENABLE: usize = PLIC + 0x2000;
const THRESHOLD: usize = PLIC + 0x20_0000;
const CLAIM: usize = THRESHOLD + 4;
const MACHINE_EXTERNAL: usize = 1 << 11;

/// UART0.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Switches UART0 on. Call it once: two handles would steal bytes from each other.
    pub fn open() -> Self {
        // The device's FIFO stays off: switching it on would throw away what the host has sent already.
        store(INTERRUPT_ENABLE, RECEIVED);
        store_word(PRIORITY, 1);
        store_word(ENABLE, 1 << UART_SOURCE);
        store_word(THRESHOLD, 0);
        // SAFETY: mstatus.MIE stays clear, so an external interrupt only ends `wfi` and runs no code.
        unsafe { asm!("csrs mie, {}", in(reg) MACHINE_EXTERNAL, options(nomem, nostack)) };
        Self(())
    }

    /// Switches UART0 on without its interrupt: for [`try_read`](Self::try_read) and writing only.
    pub fn polled() -> Self {
        store(INTERRUPT_ENABLE, 0);
        Self(())
    }

    /// The next byte, if one is there.
    pub fn try_read(&mut self) -> Option<u8> {
        Self::received().then(|| load(DATA))
    }

    fn received() -> bool {
        load(LINE_STATUS) & RECEIVED != 0
    }
}

impl ErrorType for Uart {
    type Error = LinkError;
}

impl Read for Uart {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, LinkError> {
        while !Self::received() {
            // Sleeping instead of spinning leaves the host's core to the emulator's input thread.
            // SAFETY: waits for an interrupt that runs no code.
            unsafe { asm!("wfi", options(nomem, nostack)) };
            let source = load_word(CLAIM);
            store_word(CLAIM, source);
        }
        let mut len = 0;
        for place in buf {
            if !Self::received() {
                break;
            }
            *place = load(DATA);
            len += 1;
        }
        Ok(len)
    }
}

impl Write for Uart {
    fn write(&mut self, buf: &[u8]) -> Result<usize, LinkError> {
        for &byte in buf {
            // Ends with the byte before having left, a matter of the baud rate.
            while load(LINE_STATUS) & TRANSMIT_EMPTY == 0 {}
            store(DATA, byte);
        }
        Ok(buf.len())
    }

    fn flush(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

fn load(register: usize) -> u8 {
    // SAFETY: called with the UART addresses above only, which are device registers of this board.
    unsafe { read_volatile(register as *const u8) }
}

fn store(register: usize, value: u8) {
    // SAFETY: as `load`; no register of the UART reaches memory.
    unsafe { write_volatile(register as *mut u8, value) };
}

fn load_word(register: usize) -> u32 {
    // SAFETY: called with the aligned PLIC addresses above only.
    unsafe { read_volatile(register as *const u32) }
}

fn store_word(register: usize, value: u32) {
    // SAFETY: as `load_word`; the PLIC reaches no memory.
    unsafe { write_volatile(register as *mut u32, value) };
}

/// The counter of retired instructions.
#[derive(Debug)]
pub struct Counter(());

impl Counter {
    /// It always runs.
    pub fn start() -> Self {
        Self(())
    }

    /// The present value, low word.
    #[inline(always)]
    pub fn read(&self) -> u32 {
        let value;
        // SAFETY: reads a counter.
        unsafe { asm!("csrr {}, minstret", out(reg) value, options(nostack)) };
        value
    }

    /// From one reading to a later one.
    pub const fn elapsed(before: u32, after: u32) -> u32 {
        after.wrapping_sub(before)
    }

    /// With `-icount shift=0` the emulator counts one by one.
    pub const fn instructions(counts: u32) -> u32 {
        counts
    }
}
