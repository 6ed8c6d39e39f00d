//! The table: every state with every event.

use super::state::{Action, Event, State, Then};
use crate::safety::reaction::{Reaction, Response};

/// State and action after `event` in `state`.
///
/// No wildcard: a new state or event does not compile before every pair is decided.
pub const fn next(state: State, event: Event) -> (State, Action) {
    use {Action as A, Event as E, State as S};
    match (state, event) {
        // Severity first, the same in every state: what takes torque away.
        (_, E::Fault(response)) => fault(state, response),
        (_, E::EmergencyStop { brake }) => {
            let reaction = if brake {
                Reaction::Brake
            } else {
                Reaction::Release
            };
            fault(state, Response::latched(reaction))
        }

        (S::Idle, E::Arm) => (S::Armed, A::Enable),
        (S::Idle, E::Track | E::Park | E::Drive | E::Reset) => (S::Idle, A::Refuse),
        (S::Idle, E::TrajectoryEnded | E::Reached | E::GoalUnreachable) => (S::Idle, A::Continue),
        (S::Idle, E::Halted | E::StopTimedOut | E::LinkLost) => (S::Idle, A::Continue),
        (S::Idle, E::Stop) => (S::Stopped, A::Release),

        (S::Armed, E::Arm) => (S::Armed, A::Continue),
        (S::Armed, E::Track | E::Drive) => (S::Tracking, A::StartTracking),
        (S::Armed, E::Park) => (S::Parking, A::StartParking),
        (S::Armed, E::TrajectoryEnded | E::Reached | E::GoalUnreachable) => (S::Armed, A::Continue),
        (S::Armed, E::Halted | E::StopTimedOut) => (S::Armed, A::Continue),
        // No torque flows that could be ramped down.
        (S::Armed, E::Stop | E::LinkLost) => (S::Stopped, A::Release),
        (S::Armed, E::Reset) => (S::Armed, A::Refuse),

        (S::Tracking, E::Arm | E::Reset) => (S::Tracking, A::Refuse),
        // More references for a trajectory under way, more orders, or the other of both.
        (S::Tracking, E::Track | E::Drive) => (S::Tracking, A::Continue),
        (S::Tracking, E::Park) => (S::Parking, A::StartParking),
        (S::Tracking, E::TrajectoryEnded) => (S::Parking, A::ParkAtLastReference),
        (S::Tracking, E::GoalUnreachable | E::Stop | E::LinkLost) => {
            (S::Stopping(Then::Stopped), A::BeginStop)
        }
        // Parking and stopping end by these, tracking does not.
        (S::Tracking, E::Reached | E::Halted | E::StopTimedOut) => (S::Tracking, A::Continue),

        // References that come late do not call the base back from its last goal.
        (S::Parking, E::Arm | E::Track | E::Reset) => (S::Parking, A::Refuse),
        (S::Parking, E::Park) => (S::Parking, A::StartParking),
        // An operator takes over.
        (S::Parking, E::Drive) => (S::Tracking, A::StartTracking),
        (S::Parking, E::TrajectoryEnded) => (S::Parking, A::Continue),
        (S::Parking, E::Halted | E::StopTimedOut) => (S::Parking, A::Continue),
        (S::Parking, E::Reached) => (S::Parked, A::Release),
        (S::Parking, E::GoalUnreachable | E::Stop | E::LinkLost) => {
            (S::Stopping(Then::Stopped), A::BeginStop)
        }

        (S::Parked, E::Arm) => (S::Armed, A::Enable),
        (S::Parked, E::Track | E::Drive) => (S::Tracking, A::StartTracking),
        (S::Parked, E::Park) => (S::Parking, A::StartParking),
        (S::Parked, E::TrajectoryEnded | E::Reached | E::GoalUnreachable) => {
            (S::Parked, A::Continue)
        }
        (S::Parked, E::Halted | E::StopTimedOut) => (S::Parked, A::Continue),
        // A host that comes back must arm before anything moves.
        (S::Parked, E::Stop | E::LinkLost) => (S::Stopped, A::Release),
        (S::Parked, E::Reset) => (S::Parked, A::Refuse),

        (S::Stopping(_) | S::Braking(_), E::Arm | E::Track | E::Park | E::Drive | E::Reset) => {
            (state, A::Refuse)
        }
        (
            S::Stopping(_) | S::Braking(_),
            E::TrajectoryEnded | E::Reached | E::GoalUnreachable | E::Stop | E::LinkLost,
        ) => (state, A::Continue),
        (S::Stopping(then), E::Halted) => (then.state(), A::Release),
        // A controlled stop that does not end is none.
        (S::Stopping(then), E::StopTimedOut) => (S::Braking(then), A::Brake),
        // On a slope shorted motors only creep: they stay so.
        (S::Braking(then), E::Halted | E::StopTimedOut) => (then.state(), A::Brake),

        (S::Stopped, E::Arm) => (S::Armed, A::Enable),
        (S::Stopped, E::Track | E::Park | E::Drive | E::Reset) => (S::Stopped, A::Refuse),
        (S::Stopped, E::TrajectoryEnded | E::Reached | E::GoalUnreachable) => {
            (S::Stopped, A::Continue)
        }
        (S::Stopped, E::Halted | E::StopTimedOut) => (S::Stopped, A::Continue),
        // Ordered again: a stop is never too much, nor does it let go.
        (S::Stopped, E::Stop | E::LinkLost) => (S::Stopped, A::Continue),

        (S::Fault, E::Arm | E::Track | E::Park | E::Drive) => (S::Fault, A::Refuse),
        (S::Fault, E::TrajectoryEnded | E::Reached | E::GoalUnreachable) => (S::Fault, A::Continue),
        (S::Fault, E::Halted | E::StopTimedOut) => (S::Fault, A::Continue),
        (S::Fault, E::Stop | E::LinkLost) => (S::Fault, A::Continue),
        (S::Fault, E::Reset) => (S::Idle, A::Release),
    }
}

/// A fault, by its reaction; the only thing that depends on the state is what is in force already.
const fn fault(state: State, response: Response) -> (State, Action) {
    use {Action as A, Reaction as R, State as S};
    let Response { reaction, latch } = response;
    let then = match state {
        S::Stopping(then) | S::Braking(then) => then.or(latch),
        S::Fault => Then::Fault,
        S::Idle | S::Armed | S::Tracking | S::Parking | S::Parked | S::Stopped => {
            Then::Stopped.or(latch)
        }
    };
    match (reaction, state) {
        (R::Ignore, _) => (state, A::Continue),

        (R::ControlledStop, S::Tracking | S::Parking) => (S::Stopping(then), A::BeginStop),
        (R::ControlledStop, S::Stopping(_)) => (S::Stopping(then), A::Continue),
        (R::ControlledStop | R::Brake, S::Braking(_)) => (S::Braking(then), A::Continue),
        // Nothing drives that could be driven to a stop.
        (R::ControlledStop, S::Idle | S::Armed | S::Parked | S::Stopped | S::Fault) => {
            (then.state(), A::Release)
        }

        // An armed or parked base may be rolling.
        (R::Brake, S::Armed | S::Parked | S::Tracking | S::Parking | S::Stopping(_)) => {
            (S::Braking(then), A::Brake)
        }
        // What stands may be rolling as well. What was released is not braked: the supervisor asks for a release then.
        (R::Brake, S::Idle | S::Stopped | S::Fault) => (then.state(), A::Brake),

        (
            R::Release,
            S::Idle
            | S::Armed
            | S::Tracking
            | S::Parking
            | S::Parked
            | S::Stopping(_)
            | S::Braking(_)
            | S::Stopped
            | S::Fault,
        ) => (then.state(), A::Release),
    }
}
