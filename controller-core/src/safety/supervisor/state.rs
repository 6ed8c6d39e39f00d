//! States, events, actions, outputs.

use crate::safety::reaction::{Reaction, Response};

/// Where a stop ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Then {
    /// In Stopped: arming is enough to go on.
    Stopped,
    /// In Fault: a reset is needed.
    Fault,
}

impl Then {
    /// The end when something with this latch comes on top.
    pub const fn or(self, latch: bool) -> Self {
        if latch { Self::Fault } else { self }
    }

    /// The state at the end.
    pub const fn state(self) -> State {
        match self {
            Self::Stopped => State::Stopped,
            Self::Fault => State::Fault,
        }
    }
}

/// State of the base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum State {
    /// From power-on or reset.
    #[default]
    Idle,
    /// Outputs enabled at zero torque, waiting for references or a goal.
    Armed,
    /// Following references, or driving by velocity: an order of the host is due in every tick.
    Tracking,
    /// Driving to a goal.
    Parking,
    /// At the goal, ready to go on.
    Parked,
    /// Decelerating within the limits.
    Stopping(Then),
    /// Electrically braked until at rest.
    Braking(Then),
    /// Stopped for want of a host or by an unlatched fault, or on request; must be armed again.
    Stopped,
    /// Stopped by a latched fault or an emergency stop; must be reset.
    Fault,
}

impl State {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Idle,
        Self::Armed,
        Self::Tracking,
        Self::Parking,
        Self::Parked,
        Self::Stopping(Then::Stopped),
        Self::Stopping(Then::Fault),
        Self::Braking(Then::Stopped),
        Self::Braking(Then::Fault),
        Self::Stopped,
        Self::Fault,
    ];

    /// The motion law drives to its target.
    pub const fn drives(self) -> bool {
        matches!(self, Self::Tracking | Self::Parking)
    }

    /// A stop, which rest ends.
    pub(crate) const fn ends_at_rest(self) -> bool {
        matches!(self, Self::Stopping(_) | Self::Braking(_))
    }

    /// The base moves, or may begin to: everything is watched.
    pub const fn is_live(self) -> bool {
        !matches!(self, Self::Idle | Self::Stopped | Self::Fault)
    }
}

/// What can happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The host asks for enabled outputs.
    Arm,
    /// References are there to be followed.
    Track,
    /// The host gives a goal.
    Park,
    /// The host orders a speed and a turn rate.
    Drive,
    /// The last reference of a complete trajectory was used.
    TrajectoryEnded,
    /// The base stands at its goal.
    Reached,
    /// The motion law has no retry left and is still outside the tolerance of its goal.
    GoalUnreachable,
    /// The base came to rest during a stop.
    Halted,
    /// A stop took longer than it may.
    StopTimedOut,
    /// The host asks for a controlled stop.
    Stop,
    /// No sound frame came from the host for too long. A host that is there but gives no order where one is due is
    /// [`Fault::CommandStale`](crate::safety::Fault::CommandStale).
    LinkLost,
    /// Somebody pressed the button: to brake, or to release. Latched.
    EmergencyStop {
        /// Brake the wheels; if not, release them.
        brake: bool,
    },
    /// A fault, with what is to be done about it.
    Fault(Response),
    /// The host acknowledges a fault.
    Reset,
}

impl Event {
    /// All of them, with every response.
    pub const ALL: [Self; 22] = [
        Self::Arm,
        Self::Track,
        Self::Park,
        Self::Drive,
        Self::TrajectoryEnded,
        Self::Reached,
        Self::GoalUnreachable,
        Self::Halted,
        Self::StopTimedOut,
        Self::Stop,
        Self::LinkLost,
        Self::EmergencyStop { brake: true },
        Self::EmergencyStop { brake: false },
        Self::Fault(Response::passing(Reaction::Ignore)),
        Self::Fault(Response::latched(Reaction::Ignore)),
        Self::Fault(Response::passing(Reaction::ControlledStop)),
        Self::Fault(Response::latched(Reaction::ControlledStop)),
        Self::Fault(Response::passing(Reaction::Brake)),
        Self::Fault(Response::latched(Reaction::Brake)),
        Self::Fault(Response::passing(Reaction::Release)),
        Self::Fault(Response::latched(Reaction::Release)),
        Self::Reset,
    ];
}

/// What the tick does on the way into the next state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// Nothing.
    Continue,
    /// Refuse the command; the state does not change.
    Refuse,
    /// Enable the outputs at zero torque.
    Enable,
    /// Start the controller on the first reference or velocity order.
    StartTracking,
    /// Go to the commanded goal.
    StartParking,
    /// Go to the pose of the last reference.
    ParkAtLastReference,
    /// Begin a controlled stop from the last command.
    BeginStop,
    /// Short the motors.
    Brake,
    /// End of torque: outputs as they are while standing.
    Release,
}

/// The output to the wheels in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutputMode {
    /// The motion law's torque, to its target.
    Drive,
    /// The motion law's torque, to stay at the goal.
    Hold,
    /// Outputs enabled, torque zero.
    ZeroTorque,
    /// The motion law's torque, along the plan of a stop.
    ControlledStop,
    /// Motors shorted.
    Brake,
    /// No torque, free to coast.
    Release,
}

impl OutputMode {
    /// The motion law's torque reaches the wheels.
    pub const fn has_torque(self) -> bool {
        matches!(self, Self::Drive | Self::Hold | Self::ControlledStop)
    }

    /// The reaction that this output is as severe as.
    pub const fn severity(self) -> Reaction {
        match self {
            Self::Drive | Self::Hold | Self::ZeroTorque => Reaction::Ignore,
            Self::ControlledStop => Reaction::ControlledStop,
            Self::Brake => Reaction::Brake,
            Self::Release => Reaction::Release,
        }
    }
}
