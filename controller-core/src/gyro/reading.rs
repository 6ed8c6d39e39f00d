//! What a gyro says, and what becomes of it.

use core::fmt;

pub use crate::hal::GyroReading;

/// What became of the reading of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum GyroOutcome {
    /// There was none.
    #[default]
    Absent,
    /// The heading goes by it.
    Used,
    /// The gyro is not believed at present; the reading is only compared.
    Compared,
    /// Not a reading that could be used; nothing has changed by it.
    Refused(GyroRefusal),
}

/// Why a reading cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum GyroRefusal {
    /// Rate, heading or age is NaN or infinite.
    NotFinite,
    /// It is from the future.
    NegativeAge,
    /// It is older than 0.1 s.
    TooOld,
    /// It is not newer than the last one.
    NotNewer,
    /// The rate is at or beyond the end of the range, where sensors clip.
    BeyondRange,
    /// The base was set up without a gyro.
    NoGyro,
}

/// What is wrong with a gyro.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum GyroFault {
    /// No usable reading for too long.
    Silent,
    /// The same reading again and again while the wheels turn the base.
    Stuck,
    /// It turns the other way: mounted upside down, or the wrong sign.
    Reversed,
    /// At rest it turns by more than the stated bias.
    Bias,
    /// External poses side with the wheels: wrong scale, or a jump.
    Disagrees,
}

impl fmt::Display for GyroFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Silent => "silent",
            Self::Stuck => "stuck",
            Self::Reversed => "reversed",
            Self::Bias => "bias beyond its limit",
            Self::Disagrees => "disagrees with wheels and poses",
        })
    }
}
