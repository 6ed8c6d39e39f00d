//! Missions from trajectory files.

use crate::import::{
    Figures, Format, LimitError, Options, Pace, Refusal, TimeScaling, Tolerance, Trajectory,
    format, import,
};
use crate::mission::{
    BaseSpec, Course, End, HandOverRule, LengthError, Mission, Route, When, check_length,
};
use crate::numbers::{least, most};
use crate::precision::Precision;
use controller_core::types::{Measured, Pose, Twist};

/// How close a driven reference passes the poses of its file.
///
/// Wider than the importer's own for planned files: they are printed with few digits or sampled
/// coarsely at cusps, and half a millimetre leaves angular accelerations of tens of rad/s² there,
/// which a base then pays for in time. A base of this kind tracks to about a millimetre anyway.
pub const TOLERANCE: Tolerance = Tolerance {
    position_m: 1.0e-3,
    heading_rad: 5.0e-3,
};

/// How a trajectory becomes the reference of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retiming {
    /// How fast it may be run.
    pub pace: Pace,
    /// How far its path may be departed from where that saves time, and its poses where no wheeled base passes them \[m\].
    pub tolerance_m: f64,
}

impl Default for Retiming {
    /// Nowhere faster than the file, within 10 mm of it.
    fn default() -> Self {
        Self {
            pace: Pace::Own,
            tolerance_m: 0.01,
        }
    }
}

impl Retiming {
    /// The reference, and how its time was scaled.
    ///
    /// # Errors
    /// A base whose limits are not positive, or a tolerance out of range.
    pub fn of(
        &self,
        trajectory: &Trajectory,
        base: &BaseSpec,
    ) -> Result<(Trajectory, TimeScaling), FileError> {
        self.check()?;
        let limits = base.reference_limits();
        Ok(trajectory.time_scaled_within(&limits, self.pace, self.tolerance_m)?)
    }

    /// # Errors
    /// A tolerance out of range.
    pub fn check(&self) -> Result<(), FileError> {
        match (0.0..=1.0).contains(&self.tolerance_m) {
            true => Ok(()),
            false => Err(FileError::Option("tolerance", 0.0, 1.0)),
        }
    }
}

/// How a trajectory file is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileRun {
    /// Where the robot starts: at rest, this far to the left of the first pose \[m\]; `None` is
    /// 0.15 m, or 0 on a route too short to settle from there, see [`FileRun::offset_on`].
    pub offset_m: Option<f64>,
    /// How its reference is made.
    pub retiming: Retiming,
    /// Number type of the controller.
    pub precision: Precision,
    /// Control period \[s\].
    pub period_s: f64,
}

impl Default for FileRun {
    /// Single precision, as on a chip, and 10 ms, as slow as bases of this kind are controlled.
    fn default() -> Self {
        Self {
            offset_m: None,
            retiming: Retiming::default(),
            precision: Precision::F32,
            period_s: 0.01,
        }
    }
}

/// Why a file is not run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// It cannot be driven.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The base's limits cannot be used.
    #[error(transparent)]
    Limits(#[from] LimitError),
    /// An option is out of its range.
    #[error("{} must be a number in {} to {}", .0, least(*.1), most(*.2))]
    Option(&'static str, f64, f64),
    /// The run is shorter than a tick, or would not fit a small machine's memory.
    #[error("the run {0}")]
    Length(#[from] LengthError),
}

/// How long parking may take before a run is given up \[s\].
const PARKING_S: f64 = 60.0;

impl FileRun {
    /// The offset at the start of a route of this length \[m\] and duration \[s\].
    ///
    /// From rest, 0.15 m takes 4 to 6 s to shrink to 5 mm, and at low speed a way of some 0.5 m; the
    /// last 1 to 2 s belong to parking. A route that leaves no time between them to see the robot on
    /// the path is started on it.
    pub fn offset_on(&self, length_m: f64, duration_s: f64) -> f64 {
        let long_enough = length_m >= 1.0 && duration_s >= 8.0;
        self.offset_m
            .unwrap_or(if long_enough { 0.15 } else { 0.0 })
    }

    /// What `base` is to do with a file, and how its time was scaled.
    ///
    /// # Errors
    /// A file that is refused, or options out of range.
    pub fn mission(
        &self,
        name: &str,
        bytes: &[u8],
        base: &BaseSpec,
    ) -> Result<(Mission, TimeScaling), FileError> {
        self.along(name, &trajectory(bytes, &self.retiming)?, base)
    }

    /// The same with the trajectory of a file, as [`trajectory`] reads it.
    ///
    /// # Errors
    /// Options out of range.
    pub fn along(
        &self,
        name: &str,
        trajectory: &Trajectory,
        base: &BaseSpec,
    ) -> Result<(Mission, TimeScaling), FileError> {
        let offset = self.offset_m.unwrap_or_default();
        if !(-10.0..=10.0).contains(&offset) {
            return Err(FileError::Option("offset", -10.0, 10.0));
        }
        let longest = base.motion().max_tick_s;
        if !(1.0e-4..=longest).contains(&self.period_s) {
            return Err(FileError::Option("period", 1.0e-4, longest));
        }
        let (trajectory, scaling) = self.retiming.of(trajectory, base)?;
        let figures: Figures = trajectory.figures();
        let (first, end_s) = (trajectory.at(0.0), trajectory.duration());
        let longest_s = end_s + PARKING_S;
        check_length(longest_s, self.period_s)?;
        let last = trajectory.at(end_s);
        let (sin, cos) = libm::sincos(first.theta);
        let aside = self.offset_on(figures.length_m, end_s);
        let description = format!("{} on a {}", trajectory.source(), base.name);
        let mission = Mission {
            name: name.to_owned(),
            description,
            base: base.clone(),
            robot: base.robot,
            precision: self.precision,
            start: Measured {
                pose: Pose::new(first.x - aside * sin, first.y + aside * cos, first.theta),
                twist: Twist::default(),
            },
            course: Course::Follow {
                route: Route::File(Box::new(trajectory)),
                hand_over: Some(HandOverRule {
                    goal: Pose::new(last.x, last.y, last.theta),
                    end_s,
                    when: When::Distance,
                }),
            },
            events: Vec::new(),
            period_s: self.period_s,
            end: End::Parked(longest_s),
            setup: None,
        };
        Ok((mission, scaling))
    }
}

/// The reference of a file for a base: the fastest within its limits, at a pace, in a tube.
///
/// # Errors
/// A file that is refused, a base whose limits are not positive, or a tolerance out of range.
pub fn fitted(
    bytes: &[u8],
    base: &BaseSpec,
    retiming: &Retiming,
) -> Result<(Trajectory, TimeScaling), FileError> {
    retiming.of(&trajectory(bytes, retiming)?, base)
}

/// The reference of a file, within [`TOLERANCE`] of its poses, recorded (TUM) ones within the importer's own; where no base drives that,
/// because they are noisy, within that of `retiming`. It begins and ends at rest where the file states no speeds: the robot starts from rest and parks at the
/// last pose.
///
/// # Errors
/// A file that cannot be driven.
pub fn trajectory(bytes: &[u8], retiming: &Retiming) -> Result<Trajectory, Refusal> {
    let planned = format(bytes) != Some(Format::TumPoses);
    let options = Options {
        tolerance: planned.then_some(TOLERANCE),
        tube_m: Some(retiming.tolerance_m),
        rests: true,
    };
    import(bytes, &options)
}
