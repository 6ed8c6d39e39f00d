//! A specification that cannot be met: which parameter, its value, its limit, and why.

use crate::scalar::Scalar;
use core::fmt;

/// A parameter of a design specification, by the name of its field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs)] // The names are the documentation: see `DesignParameter::name`.
pub enum DesignParameter {
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

impl DesignParameter {
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

/// What stands against a value.
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
            Self::NoTime => {
                "and not even that is long enough with the other parameters as they are"
            }
        }
    }
}

/// A specification that cannot be met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DesignError {
    /// Which.
    pub parameter: DesignParameter,
    /// The value specified.
    pub value: f64,
    /// The nearest value that can be met, with the other parameters as they are; with [`Why::NoTime`] the longest
    /// time that was tried.
    pub limit: f64,
    /// What stands against it.
    pub why: Why,
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            parameter,
            value,
            limit,
            ..
        } = self;
        let (name, why) = (parameter.name(), self.why.text());
        write!(
            f,
            "{name} = {value:.4} cannot be had: the limit is {limit:.4}, {why}"
        )
    }
}

impl core::error::Error for DesignError {}

/// A refusal.
pub(crate) fn refused<T: Scalar>(
    parameter: DesignParameter,
    value: T,
    limit: T,
    why: Why,
) -> DesignError {
    DesignError {
        parameter,
        value: value.to_f64(),
        limit: limit.to_f64(),
        why,
    }
}

/// `value` if it is in [`low`, `high`].
pub(crate) fn in_range<T: Scalar>(
    parameter: DesignParameter,
    value: T,
    low: f64,
    high: f64,
) -> Result<T, DesignError> {
    let (low, high) = (T::from_f64(low), T::from_f64(high));
    if value < low {
        Err(refused(parameter, value, low, Why::Below))
    } else if value <= high {
        Ok(value)
    } else {
        Err(refused(parameter, value, high, Why::Above))
    }
}
