//! The supervisor: the table, and what a tick needs beside it.

use super::params::{Emergency, IdleOutput, SupervisorParams, ValidSupervisorParams};
use super::state::{Action, Event, OutputMode, State, Then};
use super::table::next;
use crate::motion::AtRest;
use crate::safety::detector_params::Timeout;
use crate::safety::fault::{Fault, FaultKind};
use crate::safety::inputs::ActiveFaults;
use crate::safety::monitor::Debounce;
use crate::safety::policy::ValidPolicyParams;
use crate::safety::reaction::{Reaction, Response};

/// Why the state is what it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Cause {
    /// Power came on.
    #[default]
    PowerOn,
    /// The host asked for it.
    Host,
    /// References were there to be followed.
    References,
    /// The trajectory was complete.
    TrajectoryEnded,
    /// The base stands where it should.
    Reached,
    /// The goal was given up.
    GoalUnreachable,
    /// No sound frame came from the host for too long.
    LinkLost,
    /// Somebody pressed the button.
    EmergencyStop,
    /// The caller asked for a reaction without naming a fault.
    Demanded,
    /// Something went wrong.
    Fault(Fault),
}

/// State, cause and timers. One for a base.
///
/// A tick calls [`on`](Self::on) for what came in, [`on_active_faults`](Self::on_active_faults) for what the monitor
/// found, [`tick`](Self::tick) for the time, and applies [`output`](Self::output) to the wheels: all in
/// one tick, so that what stops the base stops it in the tick in which it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    params: SupervisorParams,
    state: State,
    cause: Cause,
    latched: Option<Fault>,
    /// Most severe reaction since the base was last armed or reset.
    worst: Reaction,
    /// Time in the present stop.
    stop_us: u32,
    rest: Debounce,
    /// A fault since the base was last armed or reset broke the measurement: rest cannot be seen in it.
    blind: bool,
    changes: u32,
    ignored: u32,
    last_ignored: Option<Fault>,
}

impl Supervisor {
    /// In [`State::Idle`].
    pub const fn new(params: &ValidSupervisorParams) -> Self {
        Self {
            params: params.0,
            state: State::Idle,
            cause: Cause::PowerOn,
            latched: None,
            worst: Reaction::Ignore,
            stop_us: 0,
            rest: Debounce::NONE,
            blind: false,
            changes: 0,
            ignored: 0,
            last_ignored: None,
        }
    }

    /// Other parameters for what is to come; state and cause stay.
    pub(crate) const fn reconfigure(&mut self, params: &ValidSupervisorParams) {
        self.params = params.0;
    }

    /// Takes an event from host, mission or caller, and says what to do.
    #[inline]
    pub fn on(&mut self, event: Event) -> Action {
        // Every tick of a base that is driven, or stands at its goal: nothing changes, for whatever demands more than that had it
        // leave this state.
        if matches!(
            (self.state, event),
            (State::Tracking, Event::Track | Event::Drive) | (State::Parked, Event::Reached)
        ) {
            return Action::Continue;
        }
        self.take(event)
    }

    #[inline(never)]
    fn take(&mut self, event: Event) -> Action {
        let cause = match event {
            Event::Arm | Event::Park | Event::Drive | Event::Stop | Event::Reset => Cause::Host,
            Event::Track => Cause::References,
            Event::TrajectoryEnded => Cause::TrajectoryEnded,
            Event::Reached => Cause::Reached,
            Event::GoalUnreachable => Cause::GoalUnreachable,
            Event::LinkLost => Cause::LinkLost,
            Event::EmergencyStop { .. } => Cause::EmergencyStop,
            Event::Fault(_) => Cause::Demanded,
            // The end of a stop has the cause of its beginning.
            Event::Halted | Event::StopTimedOut => self.cause,
        };
        self.apply(event, cause)
    }

    /// The button, with what the parameters say about it.
    pub fn emergency_stop(&mut self) -> Action {
        let brake = self.params.emergency == Emergency::Brake;
        self.on(Event::EmergencyStop { brake })
    }

    /// Takes what was found in a tick.
    ///
    /// Where nothing can move (Idle, Stopped, Fault) only a driver's fault changes the state: an idle base
    /// needs no host and no pose. Arming such a base shows within the same tick what is wrong with it.
    #[inline]
    pub fn on_active_faults(
        &mut self,
        active_faults: &ActiveFaults,
        policy: &ValidPolicyParams,
    ) -> Action {
        if active_faults.is_empty() {
            return Action::Continue;
        }
        self.meet(active_faults, policy)
    }

    #[cold]
    #[inline(never)]
    fn meet(&mut self, active_faults: &ActiveFaults, policy: &ValidPolicyParams) -> Action {
        for fault in active_faults.ignored(policy) {
            self.ignored = self.ignored.saturating_add(1);
            self.last_ignored = Some(fault);
        }
        if self.state.is_live() {
            self.blind |= active_faults
                .iter()
                .any(|fault| fault.kind().breaks_measurement());
            return match active_faults.worst(policy) {
                Some((fault, response)) => self.fail(fault, response),
                None => Action::Continue,
            };
        }
        match active_faults.get(FaultKind::Driver) {
            Some(fault) => self.fail(fault, policy.response(fault)),
            None => Action::Continue,
        }
    }

    /// Takes the time of a tick, and whether the base is known to move slower than
    /// [`SupervisorParams::rest`] says ([`Supervisor::rests`]; false where it is not known). Ends stops.
    ///
    /// After a fault that broke the measurement, rest is not believed: the brake ends by its limit alone.
    pub fn tick(&mut self, dt_us: u32, rests: bool) -> Action {
        let limit = match self.state {
            State::Stopping(_) => self.params.stop_limit,
            State::Braking(_) => self.params.brake_limit,
            State::Idle
            | State::Armed
            | State::Tracking
            | State::Parking
            | State::Parked
            | State::Stopped
            | State::Fault => return Action::Continue,
        };
        self.stop_us = self.stop_us.saturating_add(dt_us);
        let dwell = Timeout::AfterUs(self.params.rest.dwell_us);
        if self.rest.holds(rests && !self.blind, dt_us, dwell) {
            self.on(Event::Halted)
        } else if limit.passed(self.stop_us) {
            self.on(Event::StopTimedOut)
        } else {
            Action::Continue
        }
    }

    /// Whether a speed \[m/s\] and a turn rate \[rad/s\] are rest.
    pub fn rests(&self, speed_m_s: f32, turn_rad_s: f32) -> bool {
        let rest = &self.params.rest;
        speed_m_s.abs() < rest.speed_m_s && turn_rad_s.abs() < rest.turn_rad_s
    }

    /// The output to the wheels now.
    pub const fn output(&self) -> OutputMode {
        match self.state {
            State::Armed => OutputMode::ZeroTorque,
            State::Tracking | State::Parking => OutputMode::Drive,
            State::Parked => match self.params.parked {
                AtRest::Hold => OutputMode::Hold,
                AtRest::Release => OutputMode::Release,
            },
            State::Stopping(_) => OutputMode::ControlledStop,
            State::Braking(_) => OutputMode::Brake,
            State::Idle | State::Stopped | State::Fault => {
                match (self.worst, self.params.idle_output) {
                    (Reaction::Release, _) => OutputMode::Release,
                    (Reaction::Brake, _) | (_, IdleOutput::Brake) => OutputMode::Brake,
                    (_, IdleOutput::Release) => OutputMode::Release,
                }
            }
        }
    }

    /// The state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Why it is that.
    pub const fn cause(&self) -> Cause {
        self.cause
    }

    /// The first fault that latched since the last reset.
    pub const fn latched(&self) -> Option<Fault> {
        self.latched
    }

    /// Changes of state since power-on; wraps around.
    pub const fn changes(&self) -> u32 {
        self.changes
    }

    /// Faults ignored, counted once a tick, and the last of them.
    pub const fn ignored(&self) -> (u32, Option<Fault>) {
        (self.ignored, self.last_ignored)
    }

    fn fail(&mut self, fault: Fault, response: Response) -> Action {
        if response.latch && self.latched.is_none() {
            self.latched = Some(fault);
        }
        self.apply(Event::Fault(response), Cause::Fault(fault))
    }

    fn apply(&mut self, event: Event, cause: Cause) -> Action {
        let event = not_milder(event, self.output().severity(), self.worst);
        let (state, action) = next(self.state, event);
        let reaction = match action {
            // A controlled stop that does not end demands it too.
            Action::Brake => Reaction::Brake,
            _ => demanded(event),
        };
        if reaction > self.worst {
            self.worst = reaction;
        }
        let resumed = matches!(action, Action::Enable)
            || matches!((self.state, state), (State::Fault, State::Idle))
            || state.drives();
        if resumed {
            self.worst = Reaction::Ignore;
            self.blind = false;
        }
        if matches!((self.state, state), (State::Fault, State::Idle)) {
            self.latched = None;
        }
        if state != self.state {
            if !same_stop(self.state, state) {
                self.stop_us = 0;
                self.rest = Debounce::NONE;
            }
            self.state = state;
            self.cause = cause;
            self.changes = self.changes.wrapping_add(1);
        }
        action
    }
}

/// The reaction that an event demands.
const fn demanded(event: Event) -> Reaction {
    match event {
        Event::EmergencyStop { brake: true } => Reaction::Brake,
        Event::EmergencyStop { brake: false } => Reaction::Release,
        Event::Fault(response) => response.reaction,
        _ => Reaction::Ignore,
    }
}

/// The event, but with the severity of what is in force where it demands something milder: what was
/// released, such as a parked base, is not braked by a fault. The button brakes it, unless the worst reaction released it.
fn not_milder(event: Event, force: Reaction, worst: Reaction) -> Event {
    let milder = demanded(event) > Reaction::Ignore && demanded(event) < force;
    match event {
        Event::Fault(Response { latch, .. }) if milder => Event::Fault(Response {
            reaction: force,
            latch,
        }),
        Event::EmergencyStop { .. } if worst == Reaction::Release => {
            Event::EmergencyStop { brake: false }
        }
        other => other,
    }
}

/// A stop that goes on, only with another end: its time goes on too.
const fn same_stop(before: State, after: State) -> bool {
    matches!(
        (before, after),
        (
            State::Stopping(Then::Stopped | Then::Fault),
            State::Stopping(Then::Stopped | Then::Fault)
        ) | (
            State::Braking(Then::Stopped | Then::Fault),
            State::Braking(Then::Stopped | Then::Fault)
        )
    )
}

#[cfg(test)]
mod model;
