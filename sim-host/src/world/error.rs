//! What can be wrong with a world.

use crate::numbers::outside;
use thiserror::Error;

/// A parameter that no plant can have.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{key}: {}", outside(*value, *low, *high))]
pub struct WorldError {
    /// The key with its table, `motor.gear_ratio`, as in a file below `[world]`.
    pub key: String,
    /// What it is.
    pub value: f64,
    /// Smallest value that works.
    pub low: f64,
    /// Largest value that works.
    pub high: f64,
}

/// A command that a plant cannot take; nothing has moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ActuationError {
    /// NaN or infinite.
    #[error("the command is not finite")]
    NotFinite,
    /// A duty above 1.
    #[error("the duty is above 1")]
    DutyAboveOne,
    /// A duty for a world without motors.
    #[error("a duty needs [world.motor]")]
    NoMotor,
    /// A tick of no length or above a second.
    #[error("a tick lasts 1 us to 1 s")]
    BadTick,
}
