//! What every controller refuses of a tick's inputs, before it computes anything.

use crate::error::{Input, StepFault};
use crate::scalar::{Scalar, whole_microseconds};
use crate::types::Measured;

/// Refuses a measurement that is not finite.
#[inline]
pub(crate) fn check_measured<T: Scalar>(measured: &Measured<T>) -> Result<(), StepFault> {
    if measured.is_finite() {
        Ok(())
    } else {
        Err(measured_fault(measured))
    }
}

#[cold]
fn measured_fault<T: Scalar>(measured: &Measured<T>) -> StepFault {
    StepFault::NotFinite(if measured.pose.is_finite() {
        Input::Twist
    } else {
        Input::Pose
    })
}

/// Refuses a time step that is not positive, not a number or too long.
#[inline(always)]
pub(crate) fn check_tick<T: Scalar>(dt: T, max_tick: T) -> Result<(), StepFault> {
    if dt.is_positive_up_to(max_tick) {
        Ok(())
    } else {
        Err(tick_fault(dt, max_tick))
    }
}

#[cold]
fn tick_fault<T: Scalar>(dt: T, max_tick: T) -> StepFault {
    if dt > max_tick {
        let max_tick_us = whole_microseconds(max_tick);
        StepFault::TickTooLong { max_tick_us }
    } else if dt <= T::ZERO {
        StepFault::TickNotPositive
    } else {
        StepFault::NotFinite(Input::Tick)
    }
}
