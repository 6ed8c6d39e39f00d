//! What a tick is asked to do, and the checks that every controller makes before it does it.

use crate::error::{Input, StepFault};
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Measured, Pose};

/// What the caller wants of this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand<T> {
    /// Follow this sample of the reference, which belongs to the present instant.
    Track(Reference<T>),
    /// Change from tracking to parking now. The reference of the present instant is needed once
    /// more: the new law starts from what the old one would have commanded.
    HandOver {
        /// Where the reference is now: the virtual target point, with its twist.
        reference: Reference<T>,
        /// Where to park: the real target.
        goal: Pose<T>,
    },
    /// Go on parking at the goal given at the hand-over.
    Park,
}

impl<T: Scalar> Demand<T> {
    pub(crate) fn check(&self) -> Result<(), StepFault> {
        let (reference, goal) = match self {
            Self::Track(reference) => (reference.is_finite(), true),
            Self::HandOver { reference, goal } => (reference.is_finite(), goal.is_finite()),
            Self::Park => (true, true),
        };
        if !reference {
            Err(StepFault::NotFinite(Input::Reference))
        } else if !goal {
            Err(StepFault::NotFinite(Input::Goal))
        } else {
            Ok(())
        }
    }
}

/// Refuses a measurement that is not finite.
pub(crate) fn check_measured<T: Scalar>(measured: &Measured<T>) -> Result<(), StepFault> {
    if !measured.pose.is_finite() {
        Err(StepFault::NotFinite(Input::Pose))
    } else if !measured.twist.is_finite() {
        Err(StepFault::NotFinite(Input::Twist))
    } else {
        Ok(())
    }
}

/// Refuses a tick for its inputs, looking at all of them.
pub(crate) fn check_step<T: Scalar>(
    dt: T,
    max_tick: T,
    demand: &Demand<T>,
    measured: &Measured<T>,
) -> Result<(), StepFault> {
    check_tick(dt, max_tick)?;
    check_measured(measured)?;
    demand.check()
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
        // At most 1e3 s, so it fits.
        let max_tick_us = (max_tick.to_f64() * 1.0e6) as u32;
        StepFault::TickTooLong { max_tick_us }
    } else if dt <= T::ZERO {
        StepFault::TickNotPositive
    } else {
        StepFault::NotFinite(Input::Tick)
    }
}
