//! What a run leaves behind: one row per control tick.

use controller_core::paper::report::StepReport;
use controller_core::pose_error::PoseError;
use controller_core::reference::Reference;
use controller_core::types::{Measured, Pose, WheelTorques, Wrench};

/// One control tick. Torques hold from this tick to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceRow {
    /// Time \[s\].
    pub t: f64,
    /// The robot as it truly is.
    pub truth: Measured<f64>,
    /// What the robot is to be at: the moving reference, from the hand-over on the resting target.
    pub reference: Reference<f64>,
    /// The pose error as it truly is; `report.error` is what the controller made of it.
    pub error: PoseError<f64>,
    /// Everything that the controller computed.
    pub report: StepReport<f64>,
    /// An acceleration neuron is outside its bounds and on its way back.
    pub relaxing: bool,
    /// The torques that act on the robot.
    pub torques: WheelTorques<f64>,
}

/// The tick that changed from tracking to parking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandOver {
    /// Index of its row.
    pub row: usize,
    /// The virtual target point q_r(P).
    pub virtual_target: Reference<f64>,
    /// The real target q_r(N).
    pub goal: Pose<f64>,
    /// Pose error with respect to the virtual target point: the last of tracking. The row holds
    /// the first of parking.
    pub error_before: PoseError<f64>,
    /// What parking demands minus what tracking would have, at that instant.
    pub torque_step: Wrench<f64>,
}

impl TraceRow {
    /// A transition offset above [`TRANSITION_OFFSET_THRESHOLD`] is part of the command.
    pub fn has_transition_offset(&self) -> bool {
        self.report
            .has_transition_offset(TRANSITION_OFFSET_THRESHOLD)
    }
}

/// A transition offset of this size \[m/s, rad/s\] is worth reporting: it moves a torque by 1e-7 N or N m
/// with gains of 100, and is above the rounding of single precision.
pub const TRANSITION_OFFSET_THRESHOLD: f64 = 1.0e-9;

/// A closed-loop run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Control period \[s\].
    pub period_s: f64,
    /// All ticks, t = 0 first.
    pub rows: Vec<TraceRow>,
    /// The hand-over, if there was one.
    pub hand_over: Option<HandOver>,
}
