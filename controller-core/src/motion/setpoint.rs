//! What a pose law asks of the velocity loop.

use super::governor::Command;
use crate::types::{Accel, Twist};

/// A twist and its exact rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Setpoint<T> {
    pub(crate) twist: Twist<T>,
    pub(crate) rate: Accel<T>,
}

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
