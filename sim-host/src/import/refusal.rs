//! Why a file is not driven, and where.

use super::{Closeness, Format};
use crate::numbers::{digits, far, most, refused};
use std::fmt;
use thiserror::Error;

/// A place in a file. Whatever is known of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Counted from 1.
    pub line: Option<usize>,
    /// Index of the sample, counted from 0 as in JSON arrays.
    pub sample: Option<usize>,
    /// Name or path of the field.
    pub field: Option<String>,
}

impl Place {
    /// A sample that begins on a line.
    pub fn sample(line: usize, sample: usize) -> Self {
        Self {
            line: Some(line),
            sample: Some(sample),
            field: None,
        }
    }

    /// A line outside the samples.
    pub fn line(line: usize) -> Self {
        Self {
            line: Some(line),
            ..Self::default()
        }
    }

    /// The same place, with a field.
    #[must_use]
    pub fn field(self, field: impl Into<String>) -> Self {
        Self {
            field: Some(field.into()),
            ..self
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sep = "";
        if let Some(line) = self.line {
            write!(f, "line {line}")?;
            sep = ", ";
        }
        if let Some(sample) = self.sample {
            write!(f, "{sep}sample {sample}")?;
            sep = ", ";
        }
        if let Some(field) = &self.field {
            write!(f, "{sep}field `{field}`")?;
            sep = ", ";
        }
        if sep.is_empty() {
            f.write_str("the file")?;
        }
        Ok(())
    }
}

/// A file that is not driven.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{place}: {reason}")]
pub struct Refusal {
    /// What the file was taken for.
    pub format: Option<Format>,
    /// Where.
    pub place: Place,
    /// Why.
    pub reason: Reason,
}

impl Refusal {
    /// A refusal of a file of a known format.
    pub fn new(format: Format, place: Place, reason: Reason) -> Self {
        Self {
            format: Some(format),
            place,
            reason,
        }
    }
}

/// Why a file is not driven.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// Not read at all.
    #[error("the file has {bytes} bytes, more than the {limit} that are read")]
    TooLarge {
        /// Its size.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// Reading stopped.
    #[error("more than {limit} samples")]
    TooManySamples {
        /// The limit.
        limit: usize,
    },
    /// Binary data.
    #[error(
        "not text: byte {offset} is not UTF-8; a text in another encoding, as UTF-16, has to be saved as UTF-8"
    )]
    NotText {
        /// Offset of the byte.
        offset: usize,
    },
    /// Nothing but white space and comments.
    #[error("the file is empty")]
    Empty,
    /// No format fits.
    #[error(
        "not a trajectory file that is known: WPILib trajectory JSON, Choreo differential .traj, TUM poses, or CSV, with commas and not semicolons or tabs, and the header t,x,y,theta[,v,w[,a,alpha]]"
    )]
    UnknownFormat,
    /// The text breaks the rules of JSON or CSV, or a value has the wrong type.
    #[error("{0}")]
    Malformed(String),
    /// A path, not a trajectory.
    #[error("{0}")]
    Untimed(Untimed),
    /// Made for another kind of base.
    #[error("samples of a {0} base, not of a differential drive")]
    OtherDrive(&'static str),
    /// A file of Choreo before schema 0.
    #[error(
        "a trajectory of Choreo before 2025, which has no wheel speeds; open and save it with a newer Choreo"
    )]
    ChoreoTooOld,
    /// A required column.
    #[error("the column is missing; the header is t,x,y,theta[,v,w[,a,alpha]]")]
    ColumnMissing,
    /// A column that nothing is known of.
    #[error("unknown column; the header is t,x,y,theta[,v,w[,a,alpha]]")]
    ColumnUnknown,
    /// A column given twice.
    #[error("the column is there twice")]
    ColumnTwice,
    /// Too few or too many values on a line.
    #[error("{found} values where there should be {expected}")]
    WrongCount {
        /// Values on the line.
        found: usize,
        /// Values wanted.
        expected: usize,
    },
    /// Not a number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// NaN, infinite, or beyond what the field can mean.
    #[error("{} is not within ±{}", refused(*value, limit.copysign(*value)), most(*limit))]
    OutOfRange {
        /// The value.
        value: f64,
        /// Largest magnitude taken.
        limit: f64,
    },
    /// A coordinate farther from the origin than a base may be told \[m\].
    #[error("{} {}", digits(*.0), far())]
    Far(f64),
    /// Less than two samples.
    #[error("too few samples ({0}); at least two are needed")]
    TooFewSamples(usize),
    /// All samples within a moment.
    #[error("the samples span {} s, too short to drive", digits(*.0))]
    TooShort(f64),
    /// Time runs backwards.
    #[error("time goes back by {} s", digits(*.0))]
    TimeGoesBack(f64),
    /// Nothing known for too long.
    #[error("a gap of {0:.1} s since the sample before; up to 30 s are bridged")]
    Gap(f64),
    /// Two poses at one instant, or as good as that.
    #[error("a jump: {apart_m:.4} m and {apart_rad:.4} rad within {} s", digits(*dt_s))]
    Jump {
        /// Distance.
        apart_m: f64,
        /// Turn.
        apart_rad: f64,
        /// Time between them.
        dt_s: f64,
    },
    /// Headings that are those of the motion if they are taken for degrees.
    #[error(
        "headings of the file are {radians_off_rad:.2} rad off the direction of motion (mean), and {degrees_off_rad:.2} rad if they are taken for degrees: theta is in radians"
    )]
    Degrees {
        /// Mean angle between heading and motion as the file has it.
        radians_off_rad: f64,
        /// The same with the headings as degrees.
        degrees_off_rad: f64,
    },
    /// Motion in three dimensions.
    #[error("not planar: {0}")]
    NotPlanar(NotPlanar),
    /// A quaternion that is not a rotation.
    #[error("the quaternion has norm {0:.4}, not 1")]
    NotARotation(f64),
    /// No differential drive passes the poses.
    #[error(
        "no wheeled base passes here: {forward_m:.4} m along its heading and {sideways_m:.4} m across it since the sample before, turning by {turn_rad:.4} rad"
    )]
    Undrivable {
        /// Displacement along the mean heading.
        forward_m: f64,
        /// Displacement across it.
        sideways_m: f64,
        /// Turn.
        turn_rad: f64,
    },
    /// The poses have more noise than the tolerance.
    #[error(
        "the poses have noise, {scatter} (standard deviation), that no base follows: allow a tolerance of {:.3} m (`--tolerance`), or smooth the recording",
        up_to_mm(*needs_m)
    )]
    Noise {
        /// Standard deviation along an axis, and in heading.
        scatter: Closeness,
        /// The tolerance that leaves room for it \[m\].
        needs_m: f64,
    },
}

/// The next millimetre, of which a tolerance is printed.
fn up_to_mm(metres: f64) -> f64 {
    1e-3 * (1e3 * metres).ceil()
}

/// Path files without time.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum Untimed {
    /// PathWeaver's waypoints.
    #[error(
        "a PathWeaver path (waypoints with tangents): it has no time, velocity or heading along the path; build the project in PathWeaver and take the trajectory JSON it writes to `paths/output`"
    )]
    PathWeaver,
    /// PathPlanner's Bézier curves.
    #[error(
        "a PathPlanner path (Bézier control points, angles in degrees): it has no time, velocity or heading along the path; generate a trajectory from it with the base's limits and export its samples as CSV"
    )]
    PathPlanner,
    /// Choreo's project file.
    #[error("a Choreo project without generated samples: generate the trajectory in Choreo")]
    Choreo,
}

/// What leaves the plane.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum NotPlanar {
    /// Angle of the body's vertical to the world's \[rad\].
    #[error(
        "the body's vertical leans {0:.3} rad from the z axis, a wheeled base stays below 0.1 rad"
    )]
    Tilt(f64),
    /// Height above the first pose \[m\].
    #[error("{0:.3} m above or below the first pose, a wheeled base stays within 0.1 m")]
    Height(f64),
}
