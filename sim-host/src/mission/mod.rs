//! What a robot is to do: on which base, along which route, in which world.
//!
//! A [`Mission`] is what a scenario file or a trajectory file becomes; [`crate::run`] runs it.

mod base;
mod hardware;
mod reference_sampler;
mod sequencer;

pub use base::BaseSpec;
pub use hardware::{Drivers, Gyro, Hardware, OLDEST_POSE, breakaway_nm};
pub(crate) use reference_sampler::AccelerationAt;
pub(crate) use sequencer::{Orders, Sequencer};

use crate::import::Trajectory;
use crate::motion::ReferenceMotion;
use crate::precision::Precision;
use crate::world::WorldSetup;
use controller_core::reference::Reference;
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist};

/// A closed loop with the law for a real base, checked: every field is within its range.
#[derive(Clone, Debug)]
pub struct Mission {
    /// File name without its extension.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// What the controller believes of the robot.
    pub base: BaseSpec,
    /// What the robot really is.
    pub robot: Robot<f64>,
    /// Number type of the controller.
    pub precision: Precision,
    /// Where the robot is at t = 0 and how it moves.
    pub start: Measured<f64>,
    /// What it does from then on.
    pub course: Course,
    /// What changes on the way, in order of time.
    pub events: Vec<Event>,
    /// Control period \[s\].
    pub period_s: f64,
    /// When the run ends.
    pub end: End,
    /// A world to run in; none for the ideal plant with perfect measurements.
    pub setup: Option<WorldSetup>,
}

/// Longest run, in control periods: the trace of a longer one would not fit a small machine's memory.
pub const MAX_TICKS: f64 = 2.0e6;

/// A length that no run has; its `Display` goes on after what the run's length is called.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LengthError {
    /// Not a tick, or no number.
    #[error("must be a finite number and at least one control period")]
    NoTick,
    /// More than [`MAX_TICKS`].
    #[error("is {0:.0} control periods; at most {MAX_TICKS:.0} are kept: choose a longer period")]
    TooLong(f64),
}

/// # Errors
/// A run of less than one tick or more than [`MAX_TICKS`].
pub fn check_length(longest_s: f64, period_s: f64) -> Result<(), LengthError> {
    let ticks = longest_s / period_s;
    if !(ticks.is_finite() && longest_s >= period_s) {
        Err(LengthError::NoTick)
    } else if ticks > MAX_TICKS {
        Err(LengthError::TooLong(ticks))
    } else {
        Ok(())
    }
}

/// A precision that nothing computes in; its `Display` goes on after what the precision is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "is that of the law alone, on the ideal plant: in a world the whole base runs, as on a chip, in \"f32\""
)]
pub struct SingleOnly;

/// Whether a mission computes in this precision in this world, or without one.
///
/// # Errors
/// A whole base in double precision.
pub const fn check_precision(
    precision: Precision,
    setup: Option<&WorldSetup>,
) -> Result<(), SingleOnly> {
    match (precision, setup) {
        (Precision::F64, Some(_)) => Err(SingleOnly),
        _ => Ok(()),
    }
}

/// What the robot does.
#[derive(Clone, Debug)]
pub enum Course {
    /// Goes to a pose.
    Park(Pose<f64>),
    /// Drives by the velocity orders of its events; stands before the first.
    Drive,
    /// Follows a route.
    Follow {
        /// The route.
        route: Route,
        /// When to leave it and where to park; `None` follows to the end.
        hand_over: Option<HandOverRule>,
    },
}

/// A reference over time.
#[derive(Clone, Debug)]
pub enum Route {
    /// Of a file.
    File(Box<Trajectory>),
    /// By Eq. (6).
    Motion(ReferenceMotion),
}

/// When to leave a route, and where to park.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandOverRule {
    /// Where to park.
    pub goal: Pose<f64>,
    /// Time on the route at which the goal is reached \[s\].
    pub end_s: f64,
    /// When to leave.
    pub when: When,
}

/// When to leave a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// By the way to go and the speed: as late as parking takes over without overshoot.
    Distance,
    /// At a time \[s\].
    Time(f64),
}

/// Something that changes at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// \[s\].
    pub at_s: f64,
    /// What.
    pub change: Change,
}

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// The robot is to park here, whatever it is doing.
    Goal(Pose<f64>),
    /// Back to the route.
    Follow,
    /// The robot is to drive with this speed and turn rate, whatever it is doing.
    Drive(VelocityOrder),
    /// The localisation corrects itself by this much, and is right from then on (but for later
    /// jumps). It is declared to the controller.
    Jump(Pose<f64>),
}

/// A velocity order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VelocityOrder {
    /// \[m/s, rad/s\].
    pub twist: Twist<f64>,
    /// Keep the heading that the turn rates lead to.
    pub hold_heading: bool,
}

/// When a run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At a time \[s\].
    At(f64),
    /// After the robot was parked for a second, or at this time at the latest \[s\].
    Parked(f64),
}

impl Mission {
    /// The route, sampled at every tick; empty without one.
    pub(crate) fn samples(&self) -> Vec<Reference<f64>> {
        reference_sampler::ReferenceSampler::of(self, AccelerationAt::MiddleOfHold).into_samples()
    }

    /// Whether it is to stand parked when the run ends; not if that ends before it is to arrive.
    pub fn ends_parked(&self) -> bool {
        let mut changes = self.events.iter().rev().map(|event| event.change);
        let last = changes.find(|change| !matches!(change, Change::Jump(_)));
        match (last, &self.course) {
            (Some(Change::Goal(_)), _) | (None, Course::Park(_)) => true,
            (Some(Change::Drive(_)), _) => false,
            (None | Some(Change::Follow), Course::Follow { hand_over, .. }) => {
                hand_over.is_some_and(|rule| rule.end_s < self.longest_s())
            }
            _ => false,
        }
    }

    /// The time at which the run ends at the latest \[s\].
    pub fn longest_s(&self) -> f64 {
        match self.end {
            End::At(time) | End::Parked(time) => time,
        }
    }
}
