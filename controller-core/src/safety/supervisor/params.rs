//! How a supervisor stops: plain data, checked once.

use crate::error::{Field, ParamError};
use crate::motion::AtRest;
use crate::range::check_ranges;
use crate::safety::detector_params::{Timeout, time, whole};

/// What an emergency stop does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Emergency {
    /// Short the motors until a reset.
    #[default]
    Brake,
    /// Let go.
    Release,
}

/// What the wheels do in Idle, Stopped and Fault, where no reaction braked or released them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum IdleOutput {
    /// Free: the base can be pushed by hand, and rolls on a slope.
    #[default]
    Release,
    /// Shorted: on a slope the base creeps instead of rolling.
    Brake,
}

/// When a base counts as standing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RestLimits {
    /// Slower than this \[m/s\], 1e-4 to 1.
    pub speed_m_s: f32,
    /// Turning slower than this \[rad/s\], 1e-4 to 10.
    pub turn_rad_s: f32,
    /// For so long \[µs\], up to 10 s.
    pub dwell_us: u32,
}

/// How a supervisor stops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SupervisorParams {
    /// Longest controlled stop; then the wheels are braked. At least what
    /// [`crate::safety::controlled_stop`] gives for the top speed.
    pub stop_limit: Timeout,
    /// Longest electrical braking; then it ends as if the base stood, with the motors still shorted. With `Off` a braking after
    /// a fault that broke the measurement ends by an emergency stop that releases only.
    pub brake_limit: Timeout,
    /// When a stop has come to its end.
    pub rest: RestLimits,
    /// What an emergency stop does.
    pub emergency: Emergency,
    /// What the wheels do while parked.
    pub parked: AtRest,
    /// What they do in Idle, Stopped and Fault, unless they were braked or released: that lasts until the base is armed or reset.
    pub idle_output: IdleOutput,
}

impl SupervisorParams {
    /// 5 s for each stop (a base of 2.5 m/s needs 1.7 s to be at rest and 2.7 to settle), 1 cm/s and
    /// 0.02 rad/s for 0.1 s as rest, hold while parked, released while standing.
    pub const DEFAULT: Self = Self {
        stop_limit: Timeout::AfterUs(5_000_000),
        brake_limit: Timeout::AfterUs(5_000_000),
        rest: RestLimits {
            speed_m_s: 0.01,
            turn_rad_s: 0.02,
            dwell_us: 100_000,
        },
        emergency: Emergency::Brake,
        parked: AtRest::Hold,
        idle_output: IdleOutput::Release,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed; times are in µs and have to be longer than
    /// the dwell.
    pub fn validate(self) -> Result<ValidSupervisorParams, ParamError> {
        let rest = &self.rest;
        check_ranges![
            (Field::RestSpeed, rest.speed_m_s, 1.0e-4, 1.0),
            (Field::RestTurnRate, rest.turn_rad_s, 1.0e-4, 10.0),
        ]?;
        whole(Field::RestTime, rest.dwell_us, 0, 10_000_000)?;
        let least = rest.dwell_us + 1;
        time(Field::StopLimit, self.stop_limit, least)?;
        time(Field::BrakeLimit, self.brake_limit, least)?;
        Ok(ValidSupervisorParams(self))
    }
}

impl Default for SupervisorParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// [`SupervisorParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidSupervisorParams(pub(super) SupervisorParams);

impl Default for ValidSupervisorParams {
    /// [`SupervisorParams::DEFAULT`], which a test holds to be valid.
    fn default() -> Self {
        Self(SupervisorParams::DEFAULT)
    }
}
