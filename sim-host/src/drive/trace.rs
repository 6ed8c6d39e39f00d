//! What a run leaves behind: one row per control tick.

use super::note::BaseNote;
use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::motion::{Mode, MotionReport};
use controller_core::paper::report::{Phase, StepReport};
use controller_core::pose_error::PoseError;
use controller_core::reference::Reference;
use controller_core::types::{Measured, Pose, Wrench};

/// One control tick. Torques hold from this tick to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveRow {
    /// Time \[s\].
    pub t: f64,
    /// The robot as it truly is.
    pub truth: Measured<f64>,
    /// The pose that the controller got.
    pub measured: Pose<f64>,
    /// Where the robot is to be; while parking the goal.
    pub reference: Reference<f64>,
    /// The pose error as it truly is; `report.error` is what the controller made of it.
    pub error: PoseError<f64>,
    /// Everything that the controller reported.
    pub report: MotionReport<f64>,
    /// What the whole base said; none of a run on the ideal plant.
    pub base: Option<BaseNote>,
}

/// The tick that changed from following to parking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveHandOver {
    /// Index of its row.
    pub row: usize,
    /// The reference that was left.
    pub left: Reference<f64>,
    /// What the robot still had to go \[m\].
    pub distance_m: f64,
    /// Pose error with respect to the reference, the last of following.
    pub error_before: PoseError<f64>,
    /// What parking demands minus what following would have, at that instant.
    pub torque_step: Wrench<f64>,
}

/// A closed-loop run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveTrace {
    /// Control period \[s\].
    pub period_s: f64,
    /// All ticks, t = 0 first.
    pub rows: Vec<DriveRow>,
    /// The last hand-over, if there was one.
    pub hand_over: Option<DriveHandOver>,
}

impl DriveTrace {
    /// The part that all laws have in common, for figures and metrics. A run that parks from the
    /// start is handed over in its first row.
    pub fn common(&self) -> Trace {
        let parks = self
            .rows
            .last()
            .filter(|row| row.report.mode == Mode::Parking);
        let hand_over = self
            .hand_over
            .map(|h| (h.row, h.left, h.error_before, h.torque_step));
        let from_start = || {
            let first = self
                .rows
                .first()
                .filter(|row| row.report.mode == Mode::Parking)?;
            Some((0, first.reference, first.error, Wrench::default()))
        };
        let hand_over = parks.and_then(|last| {
            let (row, virtual_target, error_before, torque_step) = hand_over.or_else(from_start)?;
            Some(HandOver {
                row,
                virtual_target,
                goal: *last.reference.pose(),
                error_before,
                torque_step,
            })
        });
        Trace {
            period_s: self.period_s,
            rows: self.rows.iter().map(common).collect(),
            hand_over,
        }
    }
}

fn common(row: &DriveRow) -> TraceRow {
    let report = &row.report;
    TraceRow {
        t: row.t,
        truth: row.truth,
        reference: row.reference,
        error: row.error,
        report: StepReport {
            phase: match report.mode {
                Mode::Following => Phase::Tracking,
                Mode::Parking => Phase::Parking,
            },
            error: report.error,
            command: report.command,
            command_rate: report.command_rate,
            velocity_error: report.velocity_error,
            transition_offset: report.transition_offset,
            wrench: report.wrench,
            torques: report.torques,
            saturated: report.limited.torque,
            ..StepReport::default()
        },
        relaxing: false,
        torques: report.torques,
    }
}
