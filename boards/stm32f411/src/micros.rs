//! A clock of microseconds: a timer of 32 bits that runs free.

use board_common::Clock;
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::clocks::Clocks;

/// TIM2, counting up at 1 MHz and around at the end of 32 bits.
pub struct Micros(TIM2);

impl Micros {
    /// Starts at 0.
    pub fn start(timer: TIM2, clocks: Clocks, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        timer
            .psc()
            .write(|w| w.psc().set(clocks.per_us().wrapping_sub(1)));
        timer.arr().write(|w| w.arr().set(u32::MAX));
        // Takes over the prescaler.
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().modify(|_, w| w.cen().set_bit());
        Self(timer)
    }
}

impl Clock for Micros {
    fn now_us(&self) -> u32 {
        self.0.cnt().read().cnt().bits()
    }
}
