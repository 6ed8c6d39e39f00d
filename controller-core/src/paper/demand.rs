//! The demand of a tick, and its checks.

use crate::check::{check_measured, check_tick};
use crate::error::{Input, StepFault};
use crate::maths::Maths;
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
    /// The same in another precision; see [`Reference::cast_with`].
    pub fn cast_with<S: Scalar, M: Maths<S>>(&self) -> Demand<S> {
        match self {
            Self::Track(reference) => Demand::Track(reference.cast_with::<S, M>()),
            Self::HandOver { reference, goal } => Demand::HandOver {
                reference: reference.cast_with::<S, M>(),
                goal: goal.cast(),
            },
            Self::Park => Demand::Park,
        }
    }

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
