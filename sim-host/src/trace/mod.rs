//! What a run leaves behind: one row per control tick, whatever law drove.

mod note;

pub use note::{BaseNote, cause, fix_name, has_stopped, state_name};

use controller_core::motion::{Mode, MotionReport};
use controller_core::paper::report::NeuronStates;
use controller_core::pose_error::PoseError;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::State;
use controller_core::types::{Measured, Pose, Wrench};

/// One control tick. Torques hold from this tick to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceRow {
    /// Time \[s\].
    pub t: f64,
    /// The robot as it truly is.
    pub truth: Measured<f64>,
    /// The pose that the controller got.
    pub measured: Pose<f64>,
    /// What the robot is to be at: the moving reference; while parking the goal.
    pub reference: Reference<f64>,
    /// The pose error as it truly is; `report.error` is what the controller made of it.
    pub error: PoseError<f64>,
    /// Everything that the controller reported; the paper's laws leave what they do not compute at its default.
    pub report: MotionReport<f64>,
    /// What only the paper's laws report; none of the default law.
    pub paper: Option<PaperTerms>,
    /// What the whole base said; none of a run on the ideal plant.
    pub base: Option<BaseNote>,
}

/// Terms that only the paper's laws have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaperTerms {
    /// Neuron states after the tick.
    pub neurons: NeuronStates<f64>,
    /// An acceleration neuron is outside its bounds and on its way back.
    pub relaxing: bool,
}

/// The tick that changed from following to parking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandOver {
    /// Index of its row.
    pub row: usize,
    /// The reference that was left, the paper's virtual target point q_r(P).
    pub left: Reference<f64>,
    /// The goal, the paper's real target q_r(N).
    pub goal: Pose<f64>,
    /// What the reference still had to go \[m\].
    pub distance_m: f64,
    /// Pose error with respect to the reference that was left, the last of following. The row holds the first of
    /// parking.
    pub error_before: PoseError<f64>,
    /// What parking demands minus what following would have, at that instant.
    pub torque_step: Wrench<f64>,
}

impl TraceRow {
    /// A transition offset above [`TRANSITION_OFFSET_THRESHOLD`] is part of the command.
    pub fn has_transition_offset(&self) -> bool {
        let offset = &self.report.transition_offset;
        offset.linear.abs() > TRANSITION_OFFSET_THRESHOLD
            || offset.angular.abs() > TRANSITION_OFFSET_THRESHOLD
    }

    /// A whole base is coming to a stop that nobody asked for, or has come to one.
    fn has_stopped(&self) -> bool {
        self.base.as_ref().is_some_and(BaseNote::has_stopped)
    }

    fn parks(&self) -> bool {
        self.report.mode == Mode::Parking
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
    /// The last hand-over, if there was one.
    pub hand_over: Option<HandOver>,
}

impl Trace {
    /// The beginning of the parking that the run ends with, none if it ends otherwise: the last hand-over, with the goal
    /// as it is at the end. A run that parks from the start is handed over in its first row.
    pub fn parking(&self) -> Option<HandOver> {
        let (first, last) = (self.rows.first()?, self.rows.last()?);
        let from_start = || HandOver {
            row: 0,
            left: first.reference,
            goal: *first.reference.pose(),
            distance_m: 0.0,
            error_before: first.error,
            torque_step: Wrench::default(),
        };
        let begun = self.hand_over.or(first.parks().then(from_start))?;
        last.parks().then_some(HandOver {
            goal: *last.reference.pose(),
            ..begun
        })
    }

    /// The row in which the stop begins that the run ends with, of a whole base that nobody told to.
    pub fn stop(&self) -> Option<&TraceRow> {
        let rows = self.rows.iter().rev();
        rows.take_while(|row| row.has_stopped()).last()
    }

    /// The last row in which the robot was on the way to a goal, if it was at last, whether it got there or was stopped.
    pub fn aim(&self) -> Option<&TraceRow> {
        let last = self.rows.iter().rfind(|row| !row.has_stopped())?;
        last.parks().then_some(last)
    }

    /// Whether a parking from this row on is from the start: of a whole base the first ticks only wake it.
    pub fn parks_at_once(&self, row: usize) -> bool {
        let goal = self.rows.get(row).map(|row| *row.reference.pose());
        let waits = |row: &TraceRow| {
            let wakes = |base: BaseNote| matches!(base.state, State::Idle | State::Armed);
            row.base.is_some_and(wakes) && goal == Some(*row.reference.pose())
        };
        self.rows.iter().take(row).all(waits)
    }

    /// The first row of the parking that the run ends with, after a hand-over or for a goal that was given on the way; none if
    /// it ends otherwise.
    pub fn parks_from(&self) -> Option<usize> {
        let parking = self.rows.iter().rev().take_while(|row| row.parks());
        let parking = parking.count();
        (parking > 0).then(|| self.rows.len() - parking)
    }
}
