//! `mps2-an386`: Cortex-M4F at 25 MHz, CMSDK UART, SysTick as instruction counter.

use core::arch::asm;
use core::ptr::{read_volatile, write_volatile};

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::{NVIC, SYST, syst::SystClkSource};
use embedded_io::{ErrorType, Read, Write};

use super::LinkError;

const UART0: usize = 0x4000_4000;
const DATA: usize = UART0;
const STATE: usize = UART0 + 0x04;
const CONTROL: usize = UART0 + 0x08;
const INTERRUPTS: usize = UART0 + 0x0C;
const BAUD_DIVISOR: usize = UART0 + 0x10;
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 1 << 1;
const RECEIVE_INTERRUPT: u32 = 1 << 1;
/// Both directions on, interrupt on a received byte.
const ENABLE: u32 = 1 | 1 << 1 | 1 << 3;
const ENABLE_POLLED: u32 = 1 | 1 << 1;
/// Lowest divisor that the device accepts.
const DIVISOR: u32 = 16;

#[derive(Clone, Copy)]
struct ReceiveIrq;

// SAFETY: UART0's receive interrupt is number 0 on this board, within the 32 the NVIC has.
unsafe impl InterruptNumber for ReceiveIrq {
    fn number(self) -> u16 {
        0
    }
}

/// UART0.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Switches UART0 on. Call it once: two handles would steal bytes from each other.
    pub fn open() -> Self {
        // With interrupts masked a pending one still ends `wfi`, and no handler is needed.
        cortex_m::interrupt::disable();
        store(BAUD_DIVISOR, DIVISOR);
        store(CONTROL, ENABLE);
        // SAFETY: interrupts are masked, so unmasking this one at the NVIC runs no code.
        unsafe { NVIC::unmask(ReceiveIrq) };
        Self(())
    }

    /// Switches UART0 on without its interrupt: for [`try_read`](Self::try_read) and writing only.
    pub fn polled() -> Self {
        store(BAUD_DIVISOR, DIVISOR);
        store(CONTROL, ENABLE_POLLED);
        Self(())
    }

    /// The next byte, if one is there.
    pub fn try_read(&mut self) -> Option<u8> {
        Self::received().then(|| load(DATA) as u8)
    }

    fn received() -> bool {
        load(STATE) & RECEIVE_FULL != 0
    }
}

impl ErrorType for Uart {
    type Error = LinkError;
}

impl Read for Uart {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, LinkError> {
        while !Self::received() {
            // Sleeping instead of spinning leaves the host's core to the emulator's input thread.
            cortex_m::asm::wfi();
            store(INTERRUPTS, RECEIVE_INTERRUPT);
            NVIC::unpend(ReceiveIrq);
        }
        let mut len = 0;
        for place in buf {
            if !Self::received() {
                break;
            }
            *place = load(DATA) as u8;
            len += 1;
        }
        Ok(len)
    }
}

impl Write for Uart {
    fn write(&mut self, buf: &[u8]) -> Result<usize, LinkError> {
        for &byte in buf {
            // Ends with the byte before having left, a matter of the baud rate.
            while load(STATE) & TRANSMIT_FULL != 0 {}
            store(DATA, u32::from(byte));
        }
        Ok(buf.len())
    }

    fn flush(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

fn load(register: usize) -> u32 {
    // SAFETY: called with the addresses above only, which are device registers of this board.
    unsafe { read_volatile(register as *const u32) }
}

fn store(register: usize, value: u32) {
    // SAFETY: as `load`; no register of the UART reaches memory.
    unsafe { write_volatile(register as *mut u32, value) };
}

const SYSTICK_BITS: u32 = 0x00FF_FFFF;

/// SysTick, counting down by one each 40 ns of emulated time.
#[derive(Debug)]
pub struct Counter(());

impl Counter {
    /// Lets SysTick run over its whole range, without its interrupt.
    pub fn start() -> Self {
        // SAFETY: nothing else in these images uses SysTick.
        let mut systick = unsafe { cortex_m::Peripherals::steal() }.SYST;
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(SYSTICK_BITS);
        systick.clear_current();
        systick.enable_counter();
        Self(())
    }

    /// The present value.
    #[inline(always)]
    pub fn read(&self) -> u32 {
        let value;
        // SAFETY: reads the current-value register; one instruction, so that a reading costs the same everywhere.
        unsafe {
            asm!("ldr {}, [{}]", out(reg) value, in(reg) &raw const (*SYST::PTR).cvr, options(nostack));
        }
        value
    }

    /// From one reading to a later one; right up to 650,000 instructions.
    pub const fn elapsed(before: u32, after: u32) -> u32 {
        before.wrapping_sub(after) & SYSTICK_BITS
    }

    /// With `-icount shift=10` an instruction lasts 1024 ns, 25.6 counts.
    pub const fn instructions(counts: u32) -> u32 {
        ((counts as u64 * 40 + 512) / 1024) as u32
    }
}
