//! A wish that cannot be had: which, what was wished, what the limit is, and why.

use crate::scalar::Scalar;
use core::fmt;

/// A wish, by the name of its field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs)] // The names are the documentation: see `Wish::name`.
pub enum Wish {
    Settling,
    Damping,
    Arrival,
    SpeedLag,
    TurnLag,
    Speed,
    PoseDelay,
    TorqueDelay,
    PoseNoise,
    SteadyForce,
    SteadyError,
    FullTorqueError,
}

impl Wish {
    /// The field's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Settling => "settling_s",
            Self::Damping => "damping",
            Self::Arrival => "arrival_s",
            Self::SpeedLag => "speed_lag_s",
            Self::TurnLag => "turn_lag_s",
            Self::Speed => "speed",
            Self::PoseDelay => "pose_delay_s",
            Self::TorqueDelay => "torque_delay_s",
            Self::PoseNoise => "pose_noise_m",
            Self::SteadyForce => "force_n",
            Self::SteadyError => "error_m (steady)",
            Self::FullTorqueError => "error_m (full torque)",
        }
    }
}

/// What stands against a wish.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Why {
    /// Below the smallest accepted value.
    Below,
    /// Above the largest accepted value, or not a number.
    Above,
    /// The wheels' torque.
    Torque,
    /// The largest angular acceleration of the base.
    TurnAccel,
    /// The largest acceleration or deceleration of the base.
    Accel,
    /// The lag of the velocity loops: the pose loop would have to be faster than they are.
    Lag,
    /// The decay A of the neurons: beyond A/4 the robot runs past its goal.
    Neurons,
    /// Stability at half as much again as the stated speed.
    Stability,
    /// The delay: less than half of it would be left as margin.
    Delay,
    /// No time up to the limit helps: lags, damping or the wheels' torque stand against it.
    NoTime,
}

impl Why {
    const fn text(self) -> &'static str {
        match self {
            Self::Below => "the smallest accepted value",
            Self::Above => "the largest accepted value",
            Self::Torque => "what the wheels' torque allows",
            Self::TurnAccel => "what the largest angular acceleration allows",
            Self::Accel => "what the largest acceleration allows",
            Self::Lag => "what the lag of the velocity loops allows",
            Self::Neurons => "what the decay of the neurons allows",
            Self::Stability => "what keeps the loop stable",
            Self::Delay => "what leaves a factor of 2 to the delay that ends stability",
            Self::NoTime => "and not even that is long enough with the other wishes as they are",
        }
    }
}

/// A wish that cannot be had.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WishError {
    /// Which.
    pub wish: Wish,
    /// What was wished.
    pub value: f64,
    /// The nearest that can be had, with the other wishes as they are; with [`Why::NoTime`] the longest
    /// time that was tried.
    pub limit: f64,
    /// What stands against it.
    pub why: Why,
}

impl fmt::Display for WishError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            wish, value, limit, ..
        } = self;
        let (name, why) = (wish.name(), self.why.text());
        write!(
            f,
            "{name} = {value:.4} cannot be had: the limit is {limit:.4}, {why}"
        )
    }
}

impl core::error::Error for WishError {}

/// A refusal.
pub(crate) fn refused<T: Scalar>(wish: Wish, value: T, limit: T, why: Why) -> WishError {
    WishError {
        wish,
        value: value.to_f64(),
        limit: limit.to_f64(),
        why,
    }
}

/// `value` if it is in [`low`, `high`].
pub(crate) fn wished<T: Scalar>(wish: Wish, value: T, low: f64, high: f64) -> Result<T, WishError> {
    let (low, high) = (T::from_f64(low), T::from_f64(high));
    if value < low {
        Err(refused(wish, value, low, Why::Below))
    } else if value <= high {
        Ok(value)
    } else {
        Err(refused(wish, value, high, Why::Above))
    }
}
