//! What the robot is to do.

use crate::error::{Input, StepFault};
use crate::maths::Maths;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::Pose;

/// What the robot is to do in a tick. May change at any time; command and torque do not jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task<T = f32> {
    /// Follow this sample of a reference: its pose and twist are those of the present instant.
    /// Sample its acceleration half a tick ahead if you can, since it will be held for a tick: at
    /// 10 ms that is 1.4 to 2 times less error.
    Follow(Reference<T>),
    /// Go to this pose and stay.
    Park(Pose<T>),
}

impl<T: Scalar> Task<T> {
    /// The same in another precision; see [`Reference::cast_with`].
    pub fn cast_with<S: Scalar, M: Maths<S>>(&self) -> Task<S> {
        match self {
            Self::Follow(reference) => Task::Follow(reference.cast_with::<S, M>()),
            Self::Park(goal) => Task::Park(goal.cast()),
        }
    }

    pub(crate) fn check(&self) -> Result<(), StepFault> {
        match self {
            Self::Follow(reference) if !reference.is_finite() => {
                Err(StepFault::NotFinite(Input::Reference))
            }
            Self::Park(goal) if !goal.is_finite() => Err(StepFault::NotFinite(Input::Goal)),
            _ => Ok(()),
        }
    }

    /// Another goal than `last`, or from following to parking or back.
    pub(crate) fn is_new(&self, last: &Self) -> bool {
        match (last, self) {
            (Self::Follow(_), Self::Follow(_)) => false,
            (Self::Park(old), Self::Park(new)) => old != new,
            _ => true,
        }
    }
}
