//! Which state the robot is in and what brings it into another: a pure table, no time, no hardware.
//!
//! Torque flows in [`State::Tracking`] and [`State::Parking`] only. From every state a stop, a lost link or a
//! fault leads in one step to a state without torque; out of [`State::Fault`] leads nothing but a reset.

use serde::{Deserialize, Serialize};

/// State of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// From power-on or reset; wheels released.
    #[default]
    Idle,
    /// Outputs enabled at zero torque, waiting for references or a goal.
    Armed,
    /// Following references.
    Tracking,
    /// Driving to the goal.
    Parking,
    /// At the goal, wheels released, ready to go on.
    Parked,
    /// Stopped on request or for want of a host; must be armed again.
    Stopped,
    /// Something broke; must be reset.
    Fault,
}

impl State {
    /// Whether the control task may command a torque.
    pub const fn drives(self) -> bool {
        matches!(self, Self::Tracking | Self::Parking)
    }

    /// Whether the robot may begin to move by itself or by a command, so that everything is watched.
    pub const fn is_live(self) -> bool {
        !matches!(self, Self::Idle | Self::Stopped | Self::Fault)
    }
}

/// What can happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The host asks for enabled outputs.
    Arm,
    /// References are there to be followed.
    Track,
    /// The host gives a goal.
    Park,
    /// The last reference of a complete trajectory was used.
    TrajectoryEnded,
    /// The next reference did not arrive in time.
    Underrun,
    /// The mission says the robot stands at its goal.
    Reached,
    /// The controlled stop after an underrun has come to its end.
    Halted,
    /// The host asks for a stop.
    Stop,
    /// Nothing was heard of the host for too long.
    LinkLost,
    /// Driver, encoder, overrun or controller fault; the cause travels beside the event.
    Fault,
    /// The host acknowledges the fault.
    ResetFault,
}

/// What the control task does on the way into the next state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Nothing.
    Continue,
    /// Refuse the command; the state does not change.
    Refuse,
    /// Enable the outputs at zero torque.
    Enable,
    /// Start the controller on the first reference.
    StartTracking,
    /// Hand over, or start, to the commanded goal.
    StartParking,
    /// Hand over to the pose of the last reference.
    ParkAtLastReference,
    /// Hand over to a pose just far enough ahead: the controlled stop.
    Brake,
    /// Make the wheels safe.
    Release,
}

/// State and reaction after `event` in `state`.
///
/// No wildcard: a new state or event does not compile before every pair is decided.
pub const fn next(state: State, event: Event) -> (State, Reaction) {
    use {Event as E, Reaction as R, State as S};
    match (state, event) {
        (S::Idle, E::Arm) => (S::Armed, R::Enable),
        (S::Idle, E::Track | E::Park | E::ResetFault) => (S::Idle, R::Refuse),
        (S::Idle, E::TrajectoryEnded | E::Underrun | E::Reached | E::Halted) => {
            (S::Idle, R::Continue)
        }
        (S::Idle, E::Stop) => (S::Stopped, R::Release),
        (S::Idle, E::LinkLost) => (S::Idle, R::Continue),
        (S::Idle, E::Fault) => (S::Fault, R::Release),

        (S::Armed, E::Arm) => (S::Armed, R::Continue),
        (S::Armed, E::Track) => (S::Tracking, R::StartTracking),
        (S::Armed, E::Park) => (S::Parking, R::StartParking),
        (S::Armed, E::TrajectoryEnded | E::Underrun | E::Reached | E::Halted) => {
            (S::Armed, R::Continue)
        }
        (S::Armed, E::Stop | E::LinkLost) => (S::Stopped, R::Release),
        (S::Armed, E::Fault) => (S::Fault, R::Release),
        (S::Armed, E::ResetFault) => (S::Armed, R::Refuse),

        (S::Tracking, E::Arm | E::ResetFault) => (S::Tracking, R::Refuse),
        // More references for a trajectory under way.
        (S::Tracking, E::Track) => (S::Tracking, R::Continue),
        (S::Tracking, E::Park) => (S::Parking, R::StartParking),
        (S::Tracking, E::TrajectoryEnded) => (S::Parking, R::ParkAtLastReference),
        (S::Tracking, E::Underrun) => (S::Parking, R::Brake),
        // Parking ends by these, tracking does not.
        (S::Tracking, E::Reached | E::Halted) => (S::Tracking, R::Continue),
        (S::Tracking, E::Stop | E::LinkLost) => (S::Stopped, R::Release),
        (S::Tracking, E::Fault) => (S::Fault, R::Release),

        (S::Parking, E::Arm | E::Track | E::ResetFault) => (S::Parking, R::Refuse),
        (S::Parking, E::Park) => (S::Parking, R::StartParking),
        (S::Parking, E::TrajectoryEnded | E::Underrun) => (S::Parking, R::Continue),
        (S::Parking, E::Reached) => (S::Parked, R::Release),
        (S::Parking, E::Halted) => (S::Stopped, R::Release),
        (S::Parking, E::Stop | E::LinkLost) => (S::Stopped, R::Release),
        (S::Parking, E::Fault) => (S::Fault, R::Release),

        (S::Parked, E::Arm) => (S::Armed, R::Enable),
        (S::Parked, E::Track) => (S::Tracking, R::StartTracking),
        (S::Parked, E::Park) => (S::Parking, R::StartParking),
        (S::Parked, E::TrajectoryEnded | E::Underrun | E::Reached | E::Halted) => {
            (S::Parked, R::Continue)
        }
        // A host that comes back must arm before anything moves.
        (S::Parked, E::Stop | E::LinkLost) => (S::Stopped, R::Release),
        (S::Parked, E::Fault) => (S::Fault, R::Release),
        (S::Parked, E::ResetFault) => (S::Parked, R::Refuse),

        (S::Stopped, E::Arm) => (S::Armed, R::Enable),
        (S::Stopped, E::Track | E::Park | E::ResetFault) => (S::Stopped, R::Refuse),
        (S::Stopped, E::TrajectoryEnded | E::Underrun | E::Reached | E::Halted) => {
            (S::Stopped, R::Continue)
        }
        // Released again: a stop is never too much.
        (S::Stopped, E::Stop | E::LinkLost) => (S::Stopped, R::Release),
        (S::Stopped, E::Fault) => (S::Fault, R::Release),

        (S::Fault, E::Arm | E::Track | E::Park) => (S::Fault, R::Refuse),
        (S::Fault, E::TrajectoryEnded | E::Underrun | E::Reached | E::Halted) => {
            (S::Fault, R::Continue)
        }
        (S::Fault, E::Stop | E::LinkLost | E::Fault) => (S::Fault, R::Release),
        (S::Fault, E::ResetFault) => (S::Idle, R::Release),
    }
}

#[cfg(test)]
mod tests;
