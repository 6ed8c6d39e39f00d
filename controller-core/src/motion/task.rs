//! What the robot is to do.

use super::drive::check_order;
use super::report::Mode;
use crate::error::{Input, StepFault};
use crate::maths::Maths;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Pose, Twist};

/// What the robot is to do in a tick. May change at any time; command and torque do not jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task<T = f32> {
    /// Follow this sample of a reference: its pose and twist are those of the present instant.
    /// Sample its acceleration half a tick ahead if you can, since it will be held for a tick: at
    /// 10 ms that is 1.4 to 2 times less error.
    Follow(Reference<T>),
    /// Go to this pose and stay.
    Park(Pose<T>),
    /// Drive with this speed and turn rate, as an operator or a navigation stack orders them. Orders may change at any tick and by
    /// any size; what is beyond the limits is driven at the limits.
    Drive {
        /// Ordered \[m/s, rad/s\]; see [`check_order`](super::check_order) for its range.
        twist: Twist<T>,
        /// Keep the heading that the ordered turn rates lead to, against pushes and wheels that are not alike. Otherwise it is forgotten
        /// within half a second: what turns the robot as it sets off is turned back, to what lasts it gives in. A robot at rest keeps none.
        /// Either way a jump of the measured heading that is neither declared nor beyond
        /// [`MotionParams::jump`](super::MotionParams::jump) is turned back.
        hold_heading: bool,
    },
}

/// A task in a tick of the law, which keeps no goal: whoever calls it knows the last one.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a, T> {
    pub(crate) task: &'a Task<T>,
    /// It parks, and at another goal than in the last tick, if that parked as well.
    pub(crate) other_goal: bool,
}

impl<T: Scalar> Asked<'_, T> {
    /// Another kind of task than that of the last tick, or another goal, is another task.
    #[inline]
    pub(crate) fn is_new(&self, last: Mode) -> bool {
        self.other_goal || last != self.task.mode()
    }
}

impl<T: Scalar> Task<T> {
    /// The same in another precision; see [`Reference::cast_with`].
    pub fn cast_with<S: Scalar, M: Maths<S>>(&self) -> Task<S> {
        match self {
            Self::Follow(reference) => Task::Follow(reference.cast_with::<S, M>()),
            Self::Park(goal) => Task::Park(goal.cast()),
            &Self::Drive {
                twist,
                hold_heading,
            } => Task::Drive {
                twist: twist.cast(),
                hold_heading,
            },
        }
    }

    pub(crate) fn check(&self) -> Result<(), StepFault> {
        match self {
            Self::Follow(reference) if !reference.is_finite() => {
                Err(StepFault::NotFinite(Input::Reference))
            }
            Self::Park(goal) if !goal.is_finite() => Err(StepFault::NotFinite(Input::Goal)),
            Self::Drive { twist, .. } => check_order(twist),
            Self::Follow(_) | Self::Park(_) => Ok(()),
        }
    }

    /// What the controller is at with it.
    pub(crate) const fn mode(&self) -> Mode {
        match self {
            Self::Follow(_) => Mode::Following,
            Self::Park(_) => Mode::Parking,
            Self::Drive { .. } => Mode::Driving,
        }
    }
}
