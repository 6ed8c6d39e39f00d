//! What a pose law is given in a tick, and what it makes of it.

use super::governor::Command;
use super::setpoint::Setpoint;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// How the robot moves, measured and commanded.
#[derive(Clone, Copy)]
pub(crate) struct Moving<'a, T> {
    /// Measured.
    pub(crate) twist: &'a Twist<T>,
    /// Of the last tick.
    pub(crate) command: &'a Command<T>,
}

/// Time since the last tick.
#[derive(Clone, Copy)]
pub(crate) struct Step<T> {
    /// \[s\].
    pub(crate) dt: T,
    /// 2/dt \[1/s\]; `None` where the laws start afresh from the command: at the start, and after a jump.
    pub(crate) two_per_dt: Option<T>,
}

/// What a pose law made of a tick.
pub(crate) struct Wanted<T> {
    pub(crate) setpoint: Setpoint<T>,
    pub(crate) transition: Transition,
}

impl<T: Scalar> Wanted<T> {
    /// To stand.
    pub(crate) fn rest(transition: Transition) -> Self {
        Self {
            setpoint: Setpoint::default(),
            transition,
        }
    }

    /// What is commanded already.
    pub(crate) fn as_commanded(command: &Command<T>) -> Self {
        Self {
            setpoint: Setpoint {
                twist: command.twist,
                rate: Accel::default(),
            },
            transition: Transition::Offset,
        }
    }
}

/// How a setpoint goes on from the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Transition {
    /// From the last setpoint: the transition offset goes on fading.
    Continue,
    /// It may jump: a new transition offset starts from the command.
    Offset,
    /// From the command itself, rate and acceleration: there is no offset.
    Seamless,
}

impl Transition {
    /// Of a law that goes on unless pose, task or goal has jumped: then there is no 2/dt to take the setpoint's rate by.
    #[inline(always)]
    pub(crate) const fn after<T: Copy>(two_per_dt: Option<T>) -> Self {
        if two_per_dt.is_some() {
            Self::Continue
        } else {
            Self::Offset
        }
    }
}
