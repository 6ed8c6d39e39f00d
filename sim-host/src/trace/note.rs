//! What a whole base adds to a row, and its names for people.

use controller_core::localiser::FixOutcome;
use controller_core::safety::ActiveFaults;
use controller_core::safety::supervisor::{Cause, State};
use controller_core::types::WheelTorques;

/// What the whole base said in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseNote {
    /// Of the supervisor, after the tick.
    pub state: State,
    /// Why it is that.
    pub cause: Cause,
    /// Faults of this tick, ignored or not.
    pub active_faults: ActiveFaults,
    /// What became of an external pose.
    pub fix: FixOutcome<f32>,
    /// Asked of the wheels \[N m\]; 0 where they are braked or released.
    pub asked: WheelTorques<f64>,
}

impl BaseNote {
    /// The base is coming to a stop that nobody asked for, or has come to one.
    pub const fn has_stopped(&self) -> bool {
        has_stopped(self.state)
    }
}

/// A base in this state is coming to a stop that nobody asked of its law, or has come to one.
pub const fn has_stopped(state: State) -> bool {
    matches!(
        state,
        State::Stopping(_) | State::Braking(_) | State::Stopped | State::Fault
    )
}

/// One word for a state.
pub const fn state_name(state: State) -> &'static str {
    match state {
        State::Idle => "idle",
        State::Armed => "armed",
        State::Tracking => "tracking",
        State::Parking => "parking",
        State::Parked => "parked",
        State::Stopping(_) => "stopping",
        State::Braking(_) => "braking",
        State::Stopped => "stopped",
        State::Fault => "fault",
    }
}

/// A cause in words; a fault by the name that it has in configuration files.
pub fn cause(cause: &Cause) -> String {
    let word = match cause {
        Cause::PowerOn => "power-on",
        Cause::Host => "host",
        Cause::References => "references",
        Cause::TrajectoryEnded => "trajectory-ended",
        Cause::Reached => "reached",
        Cause::GoalUnreachable => "goal_unreachable",
        Cause::LinkLost => "link-lost",
        Cause::EmergencyStop => "emergency-stop",
        Cause::Demanded => "demanded",
        Cause::Fault(fault) => return fault.to_string(),
        _ => "another cause",
    };
    word.to_owned()
}

/// One word for what became of an external pose; empty if there was none.
pub const fn fix_name(fix: &FixOutcome<f32>) -> &'static str {
    match fix {
        FixOutcome::Absent => "",
        FixOutcome::Fused => "fused",
        FixOutcome::Rejected => "rejected",
        FixOutcome::Relocalised => "relocalised",
        FixOutcome::Refused(_) => "refused",
    }
}
