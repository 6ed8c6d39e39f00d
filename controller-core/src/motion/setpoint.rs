//! What a pose law asks of the velocity loop.

use crate::types::{Accel, Twist};

/// A twist and its exact rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Setpoint<T> {
    pub(crate) twist: Twist<T>,
    pub(crate) rate: Accel<T>,
}
