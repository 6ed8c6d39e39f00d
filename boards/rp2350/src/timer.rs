//! TIMER0: a clock of microseconds, and an alarm for the tick.

use board_common::Clock;
use cortex_m::peripheral::NVIC;
use rp_pac::{Interrupt, TIMER0};

/// TIMER0 counts microseconds; the low word wraps around at the end of 32 bits.
pub struct Micros;

impl Clock for Micros {
    fn now_us(&self) -> u32 {
        TIMER0.timerawl().read()
    }
}

/// The alarm of `TIMER0_IRQ_1`.
const ALARM: usize = 1;

/// An alarm of TIMER0, again and again.
pub struct Alarm {
    period_us: u32,
    due_us: u32,
}

impl Alarm {
    /// The first alarm is a period from now.
    pub fn start(period_us: u32) -> Self {
        let due_us = Micros.now_us().wrapping_add(period_us);
        TIMER0.inte().modify(|w| w.set_alarm(ALARM, true));
        TIMER0.alarm(ALARM).write_value(due_us);
        Self { period_us, due_us }
    }

    /// Lets the interrupt through.
    #[allow(unsafe_code)]
    pub fn unmask() {
        // SAFETY: the handler copes with coming at once, and no critical section relies on its being masked.
        unsafe { NVIC::unmask(Interrupt::TIMER0_IRQ_1) };
    }

    /// Acknowledges the alarm and sets the next one, from due time to due time so that ticks do not drift. Time that
    /// has passed already is skipped: an alarm in the past would come 71 minutes late.
    pub fn again(&mut self) {
        TIMER0.intr().write(|w| w.set_alarm(ALARM, true));
        self.due_us = self.due_us.wrapping_add(self.period_us);
        let left_us = self.due_us.wrapping_sub(Micros.now_us());
        // Less than 2 us is too near to be sure of.
        if !(2..=self.period_us).contains(&left_us) {
            self.due_us = Micros.now_us().wrapping_add(self.period_us);
        }
        TIMER0.alarm(ALARM).write_value(self.due_us);
    }
}
