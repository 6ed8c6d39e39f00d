//! One run, from power-on to its end.

use super::bounds::{Bounds, Wheels};
use super::check;
use super::expected::{self, Rule};
use super::fault_injection::{FaultInjection, FaultInjectionKind, What};
use super::host::{Answered, Host, Manner, park, stops};
use super::outcome::{Detection, End, Failing, RunOutcome, Stop, Violation, Why};
use super::plan::{Bases, Plan, Target};
use crate::closed_loop::{Board, ClosedLoopError};
use crate::mission::BaseSpec;
use crate::world::Actuation;
use controller_core::base::{BaseReport, WheelAction};
use controller_core::safety::supervisor::{Cause, State};
use controller_core::safety::{PolicyParams, Reaction};
use controller_core::types::{Pose, WheelTorques};
use firmware_demo::control_server::Queues;
use protocol::{Command, Decoder, MAX_CONTENT, RejectReason};

mod clock;
mod finish;
mod host;
mod ticks;
mod trouble;

/// Longest time to drive a base into a state, and from the trouble to the end \[s\]. Parking takes up to 10 s
/// and an approach anew 12 s of patience and as much again; three of them before a goal is given up, and a base that
/// moves about its goal, on ice for example, has several times the patience.
const LONGEST_S: (f64, f64) = (60.0, 120.0);
/// Speeds below which a base rests, and for how long \[m/s, rad/s, s\]: twice the supervisor's.
const REST: (f64, f64, f64) = (0.02, 0.04, 0.2);
/// Faster than this share of the limit a base on level floor is out of control. A wheel that is reversed or
/// stuck may add some before it is found.
const RUNAWAY: f64 = 1.5;

/// Longest time for a stop to end: the supervisor's limits of a controlled stop and of a brake, and the rest after them \[s\].
const STOP_S: f64 = 20.0;
/// The button.
const BUTTON: Command = Command::EmergencyStop { brake: true };
/// So long after it parked a base has settled \[s\]: it does not go back to its goal before.
const SETTLED_S: f64 = 1.0;

/// Something in the loop that is broken on purpose, to see that the campaign finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mutation {
    /// Nothing.
    #[default]
    None,
    /// The driver goes on with the last torque when it should release or brake.
    KeepsTorque,
    /// The brake is not connected: wheels coast.
    BrakeCoasts,
    /// Stops that have arrived are thrown away.
    LosesStops,
    /// Another policy.
    Policy(PolicyParams),
}

/// A tick of a run, to be looked at.
pub struct Tick<'a, 'queue> {
    /// World and base after the tick.
    pub board: &'a Board<'queue>,
    /// Time \[s\].
    pub t: f64,
    /// The trouble is there.
    pub injection: bool,
    /// Way since the present stop began, and its bound.
    pub stop: Stop,
}

/// Runs a plan; `watch` sees every tick.
///
/// # Errors
/// Parameters out of their range, of a policy that is not valid for example. What the base does wrong is in
/// [`RunOutcome::end`].
pub fn run(
    bases: &Bases,
    plan: &Plan,
    mutation: &Mutation,
    mut watch: impl FnMut(&Tick<'_, '_>),
) -> Result<RunOutcome, ClosedLoopError> {
    let mut queues = Queues::default();
    let mut runner = Runner::new(&mut queues, bases, plan, *mutation)?;
    let end = runner.whole(&mut watch);
    let mut outcome = runner.outcome;
    outcome.end = end.map_err(|what| Violation {
        at_s: runner.t,
        what,
    });
    Ok(outcome)
}

/// What the host wants.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Intent {
    Quiet,
    Follow,
    Park(Pose<f64>),
}

/// Frames that reached the base between two ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Received {
    /// Any, with every byte as it was sent.
    any: bool,
    /// Any that the protocol reads.
    read: bool,
    /// One that may lead out of a stop.
    frees: bool,
    /// A reset.
    reset: bool,
    /// A stop, with no such frame after it; an emergency stop if so.
    stop: Option<bool>,
}

struct Runner<'a, 'queue> {
    plan: &'a Plan,
    base: &'a BaseSpec,
    mutation: Mutation,
    board: Board<'queue>,
    host: Host,
    /// Of the bytes that reach the base, beside its own.
    reader: Decoder<Command, MAX_CONTENT>,
    bounds: Bounds,
    limit_speed: f64,
    period_s: f64,
    t: f64,
    intent: Intent,
    /// What reached the base for this tick.
    received: Received,
    /// Time by which a stop of the host is due \[s\].
    stop_at: Option<f64>,
    /// Time since the last sound frame reached the base \[s\].
    since_frame_s: f64,
    /// The same of a frame that the protocol reads \[s\].
    unread_s: f64,
    /// Something was refused that had to be.
    refused: bool,
    /// Cause of the state at the last tick.
    was: Cause,
    /// What has acted on the wheels since then, if torques did.
    acting: Option<WheelTorques<f32>>,
    /// Time that counts towards the deadline, and which way a wheel was pushed in it.
    counted_s: f64,
    pushed_way: f64,
    parked_s: f64,
    /// What went wrong as it is stated to.
    failed: Option<Failing>,
    /// Everything is mended: nothing is right to be found any more.
    mended: bool,
    /// In place, since when.
    first: Option<f64>,
    second: Option<f64>,
    /// What of them is still there.
    active: [bool; 2],
    stop: Stop,
    segment: Option<Reaction>,
    dt_worst: f64,
    torque: Actuation,
    rest_s: f64,
    way_m: f64,
    outcome: RunOutcome,
}

type Checked<T> = Result<T, String>;

impl<'a, 'queue> Runner<'a, 'queue> {
    fn new(
        queues: &'queue mut Queues,
        bases: &'a Bases,
        plan: &'a Plan,
        mutation: Mutation,
    ) -> Result<Self, ClosedLoopError> {
        let base = bases.of(plan);
        let period_s = base.hardware.map_or(0.01, |hardware| hardware.period_s);
        let board = Board::new(queues, base, &plan.setup, |params| {
            if let Mutation::Policy(policy) = mutation {
                params.policy = policy;
            }
        })?;
        Ok(Self {
            bounds: Bounds::new(base, &plan.setup, board.task().controller().base()),
            plan,
            base,
            mutation,
            board,
            host: Host::new(plan.setup.seed),
            reader: Decoder::new(),
            limit_speed: base.limits.speed,
            period_s,
            t: 0.0,
            intent: Intent::Quiet,
            received: Received::default(),
            stop_at: None,
            since_frame_s: 0.0,
            unread_s: 0.0,
            refused: false,
            was: Cause::PowerOn,
            acting: None,
            counted_s: 0.0,
            pushed_way: 0.0,
            parked_s: 0.0,
            failed: None,
            mended: false,
            first: None,
            second: None,
            active: [false; 2],
            stop: Stop::default(),
            segment: None,
            dt_worst: 0.0,
            torque: Actuation::Release,
            rest_s: 0.0,
            way_m: 0.0,
            outcome: RunOutcome::begin(plan),
        })
    }

    fn state(&self) -> State {
        self.board.report().state
    }

    fn whole(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<End> {
        self.reach(watch)?;
        let mut since = self.t;
        while self.t < since + self.plan.wait_s && self.t < LONGEST_S.0 {
            if Target::of(self.state()) != self.plan.target {
                // A parked base may go back to a goal that better poses show to be elsewhere.
                if !(self.plan.target == Target::Parked && self.state() == State::Parking) {
                    break;
                }
                since = self.t;
            }
            self.tick(watch)?;
        }
        if Target::of(self.state()) != self.plan.target {
            return Err(format!("{:?} came before the trouble", self.state()));
        }
        if self.plan.target == Target::Parked && self.parked_s >= SETTLED_S {
            self.parked()?;
        }
        self.strike();
        let end = self.settle(watch)?;
        // One that is adrift is on its way yet.
        if self.plan.again && end != End::Known(Failing::Adrift) {
            self.again(watch)?;
            self.outcome.again = true;
        }
        let end = self.failed.map_or(end, End::Known);
        Ok(end)
    }

    /// Drives the base into the state in which the trouble strikes.
    fn reach(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<()> {
        let target = self.plan.target;
        self.tick(watch)?;
        self.tick(watch)?;
        if target == Target::Idle {
            return Ok(());
        }
        self.host.ask(Command::Arm);
        match target {
            Target::Idle | Target::Armed => {}
            Target::Parking | Target::Parked => self.park(self.plan.goal),
            _ => {
                self.intent = Intent::Follow;
                self.host.follow();
            }
        }
        let mut stopped = false;
        while Target::of(self.state()) != target {
            if self.followed() > self.plan.follow_s.0 && !stopped {
                stopped = true;
                match target {
                    Target::Stopping | Target::Stopped => self.host.stop(Command::Stop),
                    Target::Braking | Target::Fault => self.host.stop(BUTTON),
                    _ => {}
                }
            }
            self.tick(watch)?;
            if self.t > LONGEST_S.0 {
                return Err(format!("never {}", target.name()));
            }
        }
        Ok(())
    }

    /// From the trouble to the end.
    fn settle(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<End> {
        let since = self.t;
        let mut stopping_since = None;
        let mut woken = !(self.plan.wake && self.plan.target.waits());
        let mut quiet_from = self.t;
        loop {
            let after = self.t - since;
            if self.active[0] && self.plan.heal_s.is_some_and(|heal| after >= heal) {
                self.heal(0);
                quiet_from = self.t;
            }
            // A host that is silent wakes nobody, and one that is about to stop a base does not either.
            if !woken && after >= 0.5 && self.stop_at.is_none() {
                woken = true;
                quiet_from = self.t;
                self.wake();
            }
            if self.stop_at.is_some_and(|at| self.t >= at) {
                self.stop_by_host();
                quiet_from = self.t;
            }
            if self.plan.target == Target::Tracking
                && self.intent == Intent::Follow
                && after > self.plan.follow_s.1
            {
                self.park_ahead();
            }
            let stops = matches!(self.state(), State::Stopping(_) | State::Braking(_));
            if stops && stopping_since.is_none() {
                stopping_since = Some(self.t);
            }
            self.strike_again(stopping_since);
            self.tick(watch)?;
            self.detect(after + self.period_s);
            self.overdue()?;
            if let Some(end) = self.ended(self.t - quiet_from, woken)? {
                return Ok(end);
            }
            // A stop that has begun by then may end.
            let longest = if check::stops(self.state()) {
                LONGEST_S.1 + STOP_S
            } else {
                LONGEST_S.1
            };
            if self.t - since > longest {
                if self.state() == State::Parking && self.is_known(Failing::Adrift) {
                    return Ok(End::Known(Failing::Adrift));
                }
                return Err(format!(
                    "neither parked nor stopped: {:?}, resting for {:.1} s",
                    self.state(),
                    self.rest_s
                ));
            }
        }
    }
}
