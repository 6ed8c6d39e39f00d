//! How the control task watches over itself: plain data, checked once.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

/// When a silent host stops the wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkWatch {
    /// After this many microseconds without a sound frame.
    StopAfterUs(u32),
    /// Never: for a robot that follows a trajectory from its own flash.
    Off,
}

/// When a wheel counts as stuck: told to turn, and standing still all the while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StallWatch {
    /// Least torque that turns a free wheel \[N m\].
    pub torque_nm: f32,
    /// Slower than this is standing still \[rad/s\].
    pub speed_rad_s: f32,
    /// For how long \[us\].
    pub after_us: u32,
}

/// When the robot has arrived, and stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Error along the heading \[m\]. The parking law does not control the error across, so that one is
    /// reported and not waited for.
    pub along_m: f32,
    /// Error of the heading \[rad\].
    pub heading_rad: f32,
    /// Speed \[m/s\].
    pub speed_m_s: f32,
    /// Turn rate \[rad/s\].
    pub turn_rad_s: f32,
    /// For how long all of them are to hold \[us\].
    pub dwell_us: u32,
}

/// Everything the control task needs to know beside the controller's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Time between ticks \[us\], 100 to 100,000.
    pub period_us: u32,
    /// A tick later than this after the one before is an overrun \[us\].
    pub late_us: u32,
    /// So many overruns in a row are a fault; at least 1.
    pub overruns_to_fault: u8,
    /// Watch over the host.
    pub link: LinkWatch,
    /// Watch over the encoders.
    pub stall: StallWatch,
    /// End of parking.
    pub arrival: Arrival,
    /// Longest controlled stop \[us\]; then the wheels are released, moving or not.
    pub stop_limit_us: u32,
}

impl Default for Settings {
    /// 1 kHz; the host may be silent for 100 ms.
    fn default() -> Self {
        Self {
            period_us: 1000,
            late_us: 1500,
            overruns_to_fault: 5,
            link: LinkWatch::StopAfterUs(100_000),
            stall: StallWatch {
                torque_nm: 0.5,
                speed_rad_s: 0.02,
                after_us: 250_000,
            },
            arrival: Arrival {
                along_m: 0.02,
                heading_rad: 0.05,
                speed_m_s: 0.01,
                turn_rad_s: 0.02,
                dwell_us: 300_000,
            },
            stop_limit_us: 5_000_000,
        }
    }
}

/// The first setting that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingError {
    /// `period_us` is not in 100 to 100,000.
    Period,
    /// `late_us` is not above the period.
    Late,
    /// `overruns_to_fault` is 0.
    Overruns,
    /// The silence is not longer than two periods.
    Link,
    /// A threshold of the stall watch is not positive and finite, or its time is 0.
    Stall,
    /// A tolerance of the arrival is not positive and finite.
    Arrival,
    /// `stop_limit_us` is not longer than the dwell.
    StopLimit,
    /// The controller's wheel torque is unlimited, or above what the wheel driver can do.
    TorqueLimit,
}

impl Display for SettingError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Period => "period_us is not in 100 to 100,000",
            Self::Late => "late_us is not above period_us",
            Self::Overruns => "overruns_to_fault is 0",
            Self::Link => "the silence of the link is not longer than two periods",
            Self::Stall => "the stall watch has a threshold that is not positive",
            Self::Arrival => "the arrival has a tolerance that is not positive",
            Self::StopLimit => "stop_limit_us is not longer than the dwell of the arrival",
            Self::TorqueLimit => "max_wheel_torque is unlimited or above that of the driver",
        })
    }
}

impl Error for SettingError {}

impl Settings {
    /// Checks every setting.
    ///
    /// # Errors
    ///
    /// The first one out of its range.
    pub fn validate(self) -> Result<ValidSettings, SettingError> {
        let positive = |value: f32| value > 0.0 && value.is_finite();
        let Self { stall, arrival, .. } = &self;
        let link = match self.link {
            LinkWatch::StopAfterUs(us) => us > self.period_us.saturating_mul(2),
            LinkWatch::Off => true,
        };
        let checks = [
            (
                (100..=100_000).contains(&self.period_us),
                SettingError::Period,
            ),
            (self.late_us > self.period_us, SettingError::Late),
            (self.overruns_to_fault > 0, SettingError::Overruns),
            (link, SettingError::Link),
            (
                positive(stall.torque_nm) && positive(stall.speed_rad_s) && stall.after_us > 0,
                SettingError::Stall,
            ),
            (
                positive(arrival.along_m)
                    && positive(arrival.heading_rad)
                    && positive(arrival.speed_m_s)
                    && positive(arrival.turn_rad_s),
                SettingError::Arrival,
            ),
            (
                self.stop_limit_us > arrival.dwell_us,
                SettingError::StopLimit,
            ),
        ];
        for (holds, error) in checks {
            if !holds {
                return Err(error);
            }
        }
        Ok(ValidSettings(self))
    }
}

/// [`Settings`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidSettings(Settings);

impl ValidSettings {
    /// The settings.
    pub const fn get(&self) -> &Settings {
        &self.0
    }
}
