//! `mps2-an386`: SysTick interrupts, CMSDK timer 0 tells the time, both at 25 MHz.

use core::ptr::{read_volatile, write_volatile};

use cortex_m::peripheral::{SYST, syst::SystClkSource};

const TIMER0: usize = 0x4000_0000;
const CONTROL: usize = TIMER0;
const VALUE: usize = TIMER0 + 4;
const RELOAD: usize = TIMER0 + 8;

/// Of the clock that tells the time.
pub const COUNTS_PER_US: u32 = 25;

/// SysTick and timer 0.
pub struct Timer {
    systick: SYST,
}

impl Timer {
    /// Both run, the interrupt is off. At most 0.67 s of period.
    pub fn new(period_us: u32) -> Self {
        store(RELOAD, u32::MAX);
        store(VALUE, u32::MAX);
        store(CONTROL, 1);
        // SAFETY: whoever ticks does not count instructions, the other use of SysTick.
        let mut systick = unsafe { cortex_m::Peripherals::steal() }.SYST;
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(period_us.saturating_mul(COUNTS_PER_US).saturating_sub(1));
        systick.clear_current();
        systick.enable_counter();
        Self { systick }
    }

    /// Time in counts, wraps around.
    pub fn counts(&self) -> u32 {
        // SAFETY: reads a device register of this board.
        !unsafe { read_volatile(VALUE as *const u32) }
    }

    /// Nothing to do: SysTick reloads by itself.
    pub fn acknowledge(&mut self) {
        // Reading clears the flag that it has wrapped.
        let _ = self.systick.has_wrapped();
    }

    /// Lets the interrupt through.
    pub fn enable() {
        // SAFETY: the handler is there and its state is set.
        unsafe {
            cortex_m::Peripherals::steal().SYST.enable_interrupt();
            cortex_m::interrupt::enable();
        }
    }

    /// Holds the interrupt back.
    pub fn disable() {
        // SAFETY: switching an interrupt off runs no code.
        unsafe { cortex_m::Peripherals::steal() }
            .SYST
            .disable_interrupt();
    }
}

fn store(register: usize, value: u32) {
    // SAFETY: called with the addresses above only, which are device registers of this board.
    unsafe { write_volatile(register as *mut u32, value) };
}

/// Makes SysTick's interrupt of this binary the one of [`board::with_ticks`](crate::board::with_ticks).
#[macro_export]
macro_rules! timer_interrupt {
    () => {
        #[cortex_m_rt::exception]
        fn SysTick() {
            $crate::board::interrupt();
        }
    };
}
