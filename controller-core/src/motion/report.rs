//! Everything that a tick computed, in one value.

use super::load::Load;
use crate::cast::cast;
use crate::pose_error::PoseError;
use crate::types::{Accel, Twist, WheelTorques, Wrench};

/// What the controller is at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Following a moving reference.
    #[default]
    Following,
    /// Going to a pose at rest.
    Parking,
    /// Driving by velocity.
    Driving,
}

/// What came of it so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Outcome {
    /// On the way.
    #[default]
    Driving,
    /// At the goal within tolerance, and staying.
    Parked,
    /// A speed was commanded for long, and the robot does not move.
    Stalled,
    /// At rest near the goal but outside of the tolerance, after all retries. Stays until a new task.
    OutOfTolerance,
}

/// Which limits were at work in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Limited {
    /// The command was held at the largest speed or turn rate, or more than that is ordered.
    pub speed: bool,
    /// The command was slewed by acceleration, braking or what the wheels can exert.
    pub accel: bool,
    /// The fed-forward acceleration was slewed by jerk.
    pub jerk: bool,
    /// A wheel torque was at its limit; the command was set back to what is achieved.
    pub torque: bool,
    /// The disturbance estimate was at its bound: what is beyond is not compensated.
    pub disturbance: bool,
    /// Wheels slid on the way to this goal: manoeuvres to it have half the accelerations.
    pub grip: bool,
}

/// The report of one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionReport<T = f32> {
    /// Following, parking or driving by velocity.
    pub mode: Mode,
    /// Whether the robot got there.
    pub outcome: Outcome,
    /// Pose error in the body frame, Eq. (8); while driving by velocity that of the heading that is held.
    pub error: PoseError<T>,
    /// What the pose law wants.
    pub desired: Twist<T>,
    /// Its exact rate.
    pub desired_rate: Accel<T>,
    /// What past jumps still add to it.
    pub transition_offset: Twist<T>,
    /// What is asked of the velocity loop, within all limits.
    pub command: Twist<T>,
    /// Fed forward, within all limits.
    pub command_rate: Accel<T>,
    /// Measured minus commanded twist.
    pub velocity_error: Twist<T>,
    /// Estimated force and moment that act on the robot beside its wheels.
    pub disturbance: Wrench<T>,
    /// Mass and inertia found beyond those stated, as shares of them. What is fed forward is (1 + share) times as much.
    pub load: Load<T>,
    /// What the law asks for, before the wheels' limit.
    pub wrench: Wrench<T>,
    /// What the wheels are to exert \[N m\], within their limit.
    pub torques: WheelTorques<T>,
    /// Limits at work.
    pub limited: Limited,
    /// This tick took a jump: a new task, a new goal, a declared or detected jump of the pose.
    pub jumped: bool,
    /// While parking: the robot backs up.
    pub backing: bool,
    /// New approaches to this goal so far, since the robot stood outside of the tolerance.
    pub retries: u8,
}

cast!(
    MotionReport {
        error,
        desired,
        desired_rate,
        transition_offset,
        command,
        command_rate,
        velocity_error,
        disturbance,
        load,
        wrench,
        torques,
    } keeps mode, outcome, limited, jumped, backing, retries
);
