//! What a rival is.

use controller_core::maths::{Maths, Single};
use controller_core::motion::Limits;
use controller_core::pose_error::{PoseError, pose_error};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

/// A number to turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// For people.
    pub name: &'static str,
    /// As published, or as most users have it.
    pub usual: f32,
}

/// What a law may know of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Speeds and accelerations.
    pub limits: Limits<f32>,
    /// Control period \[s\].
    pub period_s: f32,
    /// A goal is reached within this distance \[m\].
    pub distance_m: f32,
    /// And this heading error \[rad\].
    pub heading_rad: f32,
}

/// The present instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Now {
    /// Estimated.
    pub pose: Pose<f32>,
    /// Estimated.
    pub twist: Twist<f32>,
    /// Since the last tick \[s\].
    pub dt: f32,
}

/// A path over time, sampled once a control period.
#[derive(Clone, Copy, Debug)]
pub struct Path<'a> {
    /// From its start to its end.
    pub samples: &'a [Reference<f32>],
    /// The sample of this instant; beyond the end it has come to rest there.
    pub tick: usize,
}

impl Path<'_> {
    /// The reference of this instant and of `later` periods after it.
    pub fn at(&self, later: usize) -> Option<Reference<f32>> {
        let last = self.samples.last()?;
        let at = self.tick.saturating_add(later);
        let found = self.samples.get(at).copied();
        Some(found.unwrap_or_else(|| Reference::at_rest(*last.pose())))
    }
}

/// What is to be done.
#[derive(Clone, Copy, Debug)]
pub enum Job<'a> {
    /// Be where the path is.
    Follow(Path<'a>),
    /// Come to rest here.
    Park(Pose<f32>),
}

/// What a law wants.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Speed and turn rate.
    pub twist: Twist<f32>,
    /// Their rates, where the law knows them.
    pub accel: Option<Accel<f32>>,
}

impl Wanted {
    /// A twist whose rates are not known.
    pub const fn of(linear: f32, angular: f32) -> Self {
        Self {
            twist: Twist::new(linear, angular),
            accel: None,
        }
    }

    /// With the rates of a reference.
    pub const fn with(self, accel: Accel<f32>) -> Self {
        Self {
            accel: Some(accel),
            ..self
        }
    }
}

/// A law that wants twists.
pub trait Rival {
    /// What it wants now; none where it has no answer to such a job.
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted>;
}

/// Goal minus robot, in the robot's frame.
pub(crate) fn error(goal: &Pose<f32>, pose: &Pose<f32>) -> PoseError<f32> {
    pose_error::<f32, Single>(goal, pose)
}

pub(crate) fn sin_cos(angle: f32) -> (f32, f32) {
    Single::sin_cos(angle)
}

pub(crate) fn atan2(y: f32, x: f32) -> f32 {
    Single::atan2(y, x)
}

/// 0 for what is below it by rounding.
pub(crate) fn sqrt(value: f32) -> f32 {
    Single::sqrt(if value > 0.0 { value } else { 0.0 })
}

pub(crate) fn norm(x: f32, y: f32) -> f32 {
    sqrt(x * x + y * y)
}

/// sin x / x.
pub(crate) fn sinc(x: f32) -> f32 {
    if x.abs() < 1.0e-3 {
        1.0 - x * x * (1.0 / 6.0)
    } else {
        sin_cos(x).0 / x
    }
}

pub(crate) fn clamp(value: f32, most: f32) -> f32 {
    between(value, -most, most)
}

pub(crate) fn between(value: f32, least: f32, most: f32) -> f32 {
    if value > most {
        most
    } else if value < least {
        least
    } else {
        value
    }
}

/// A gain of a list; 0 behind its end.
pub(crate) fn gain(gains: &[f32], at: usize) -> f32 {
    gains.get(at).copied().unwrap_or(0.0)
}
