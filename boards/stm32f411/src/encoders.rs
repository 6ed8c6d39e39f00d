//! Both encoders, counted by two timers.

use board_common::{ErrorType, WheelCounts, WheelEncoders, Widened};
use core::convert::Infallible;
use embedded_hal_02::Qei as _;
use stm32f4xx_hal::pac::{TIM3, TIM4};
use stm32f4xx_hal::qei::Qei;

/// The timers and what makes 32 bits of their 16.
pub struct Encoders {
    right: Qei<TIM3>,
    left: Qei<TIM4>,
    right_total: Widened,
    left_total: Widened,
}

impl Encoders {
    /// From here on positions count from 0.
    pub fn new(right: Qei<TIM3>, left: Qei<TIM4>) -> Self {
        let (right_total, left_total) = (Widened::new(right.count()), Widened::new(left.count()));
        Self {
            right,
            left,
            right_total,
            left_total,
        }
    }
}

impl ErrorType for Encoders {
    type Error = Infallible;
}

impl WheelEncoders for Encoders {
    fn counts(&mut self) -> Result<WheelCounts, Infallible> {
        let (right, left) = (self.right.count(), self.left.count());
        Ok(WheelCounts {
            right: self.right_total.update(right),
            left: self.left_total.update(left),
        })
    }
}
