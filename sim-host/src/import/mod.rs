//! Trajectory files that people have, as references that a wheeled base can follow.
//!
//! [`import`] reads a file of any [`Format`], recognised by its content, and returns a [`Trajectory`]
//! or a [`Refusal`] with line, field and reason; [`FileVerdict`] prints either. Files are dirty; what was repaired is listed with its place.
//!
//! # How a reference is made
//!
//! Sampled speeds, curvatures and accelerations of real files contradict their own poses (by
//! 0.2 rad per sample in one, 300 rad/s² in others), and exact feed-forward of a contradiction is
//! an error of the tracker. So only times and poses count. The reference is the motion with the
//! least squared jerk, in v and in w, among those that satisfy Eq. (6) and pass every pose of the
//! file within a [`Tolerance`]: see `fit`. Its jerk is constant between knots at most 25 ms apart,
//! so that v, w are quadratic, θ is cubic, a and α are continuous, and x, y are integrals taken by
//! Gauss-Legendre quadrature. [`Trajectory::at`] evaluates the same formulas at any instant: pose′ =
//! (v cos θ, v sin θ, w) holds within 1e-9, there is no interpolation besides. First and last pose
//! are passed a hundred times closer than the others, and at rest where the file says so. Poses with
//! noise are passed as far off as it needs, the first and the last like the others: see `noise`.
//!
//! Speeds of a file still serve: to distinguish a turn from the turn the other way round when samples are
//! far apart, to know rest, and for the verdict, which lists columns that contradict the poses.
//!
//! # Limits
//!
//! [`Trajectory::time_scaled`] runs the same path in the least time within a base's [`ReferenceLimits`],
//! if wished nowhere faster than the file; [`Trajectory::time_scaled_within`] smooths the path inside a
//! tube where that saves time; [`compact()`] thins a trajectory to samples for a chip.
//!
//! # Bounds
//!
//! Files up to [`MAX_BYTES`] with up to [`MAX_SAMPLES`] samples are read; time and memory are
//! linear in both. No input makes a panic.

#[cfg(feature = "datalog")]
mod bag;
mod choreo;
mod closeness;
mod columns;
mod compact;
mod detect;
mod figures;
mod fit;
mod format;
mod interior;
mod joint;
mod json;
mod limits;
mod noise;
mod options;
mod ramps;
mod raw;
mod refusal;
mod repair;
pub(crate) mod table;
mod time_optimal;
mod time_scaling;
mod time_warp;
mod trajectory;
mod tube;
mod tum;
mod verdict;
mod wpilib;

#[cfg(feature = "datalog")]
pub use bag::bag_poses;
pub use closeness::Closeness;
pub use compact::{Compact, CompactSample, compact};
pub use figures::Figures;
pub use format::Format;
pub use limits::{Bound, DriveLimits, LimitError, ReferenceLimits};
pub use options::{Options, Tolerance};
pub use refusal::{NotPlanar, Place, Reason, Refusal, Untimed};
pub use repair::{Fix, Repair};
pub use time_scaling::{Pace, ScaledSpan, TimeScaling};
pub use trajectory::{Sample, Trajectory};
pub use verdict::FileVerdict;

use raw::Raw;
use std::borrow::Cow;

/// Largest file that is read: 64 MiB.
pub const MAX_BYTES: usize = 64 << 20;
/// Most samples of a file: more than half an hour at 100 Hz.
pub const MAX_SAMPLES: usize = 200_000;

/// Reads a file and makes the reference of it.
///
/// ```
/// use sim_host::import::{Options, import};
///
/// let file = "t,x,y,theta\n0,0,0,0\n0.5,0.1,0,0\n1,0.2,0,0\n";
/// let trajectory = import(file.as_bytes(), &Options::default())?;
/// let middle = trajectory.at(0.75);
/// assert!((middle.x - 0.15).abs() < 1e-3 && (middle.v - 0.2).abs() < 0.01);
/// # Ok::<(), sim_host::import::Refusal>(())
/// ```
///
/// # Errors
/// A file that cannot be read or driven; the refusal says where and why.
pub fn import(bytes: &[u8], options: &Options) -> Result<Trajectory, Refusal> {
    let mut raw = read(bytes)?;
    let start = raw.clean()?;
    Trajectory::of(raw, start, options)
}

/// The format of a file, if it has one that is known.
pub fn format(bytes: &[u8]) -> Option<Format> {
    text(bytes).ok().and_then(|text| detect::detect(&text).ok())
}

/// The text of a file, with lines that end as here. Those that end in CR alone would be none to what finds comments.
pub(crate) fn text(bytes: &[u8]) -> Result<Cow<'_, str>, Refusal> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        let good = bytes.get(..offset).unwrap_or_default();
        Refusal {
            format: None,
            place: Place::line(1 + good.iter().filter(|&&b| b == b'\n').count()),
            reason: Reason::NotText { offset },
        }
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    Ok(match text.contains('\r') {
        true => Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n")),
        false => Cow::Borrowed(text),
    })
}

/// Whether a line of a table says nothing: it is empty, or a `#` comment, indented or not.
pub(crate) fn says_nothing(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with('#')
}

/// The samples as they stand in the file.
fn read(bytes: &[u8]) -> Result<Raw, Refusal> {
    if bytes.len() > MAX_BYTES {
        return Err(Refusal {
            format: None,
            place: Place::default(),
            reason: Reason::TooLarge {
                bytes: bytes.len(),
                limit: MAX_BYTES,
            },
        });
    }
    let text = text(bytes)?;
    let text = &*text;
    match detect::detect(text)? {
        Format::WpilibJson => wpilib::read(text),
        Format::ChoreoTraj => choreo::read(text),
        Format::TumPoses => tum::read(text),
        Format::Csv => table::read(text),
        format @ Format::PathWeaver => Err(Refusal::new(
            format,
            Place::line(1),
            Reason::Untimed(Untimed::PathWeaver),
        )),
        format @ Format::PathPlanner => Err(Refusal::new(
            format,
            Place::default().field("waypoints"),
            Reason::Untimed(Untimed::PathPlanner),
        )),
    }
}
