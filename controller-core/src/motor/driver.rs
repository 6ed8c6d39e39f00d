//! What takes a base's commands.

use super::params::{Motor, MotorParams};
use super::speed::{SpeedOutput, SpeedParams};
use crate::error::ParamError;
use crate::scalar::Scalar;

/// What drives the wheels of a base, and takes of each [`DriveCommand`](crate::base::DriveCommand) what it can make use of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// Stored parameters have the number of the variant: new ones are appended.
#[allow(clippy::large_enum_variant)] // One of it in a base, which has no heap.
pub enum DriverParams<T = f32> {
    /// Drivers that control the torque by themselves.
    #[default]
    Torques,
    /// Brushed motors on bridges, which take duties.
    Motors(MotorParams<T>),
    /// Drivers that close their own speed loop.
    Speeds(SpeedParams<T>),
}

/// [`DriverParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // As there.
pub enum Driver<T = f32> {
    /// Takes torques.
    Torques,
    /// Takes duties.
    Motors(Motor<T>),
    /// Takes wheel speeds.
    Speeds(SpeedOutput<T>),
}

impl<T: Scalar> DriverParams<T> {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first one out of its range.
    pub fn validate(self) -> Result<Driver<T>, ParamError> {
        Ok(match self {
            Self::Torques => Driver::Torques,
            Self::Motors(motor) => Driver::Motors(motor.validate()?),
            Self::Speeds(speeds) => Driver::Speeds(speeds.validate()?),
        })
    }
}

impl<T> DriverParams<T> {
    /// The motors, if they are on bridges.
    pub const fn motor(&self) -> Option<&MotorParams<T>> {
        match self {
            Self::Motors(motor) => Some(motor),
            Self::Torques | Self::Speeds(_) => None,
        }
    }
}

impl<T> Driver<T> {
    /// The motors, if they are on bridges.
    #[inline(always)]
    pub const fn motor(&self) -> Option<&Motor<T>> {
        match self {
            Self::Motors(motor) => Some(motor),
            Self::Torques | Self::Speeds(_) => None,
        }
    }

    /// What drivers that close their own speed loop take.
    #[inline(always)]
    pub const fn speeds(&self) -> Option<&SpeedOutput<T>> {
        match self {
            Self::Speeds(speeds) => Some(speeds),
            Self::Torques | Self::Motors(_) => None,
        }
    }
}
