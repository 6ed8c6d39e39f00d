//! One run, from power-on to its end.

use super::bounds::{Bounds, Wheels};
use super::check;
use super::expected;
use super::outcome::{Detection, End, Outcome, Stop, Violation, Why};
use super::path::narrow;
use super::plan::{Bases, Plan, Target};
use super::upset::{Upset, UpsetKind, What};
use crate::drive::Base;
use crate::rig::{Rig, RigError};
use crate::world::Actuation;
use controller_core::base::{Order, WheelAction};
use controller_core::safety::supervisor::{Action, Event, State};
use controller_core::safety::{FaultKind, PolicyParams, Reaction};
use controller_core::types::Pose;

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

/// Time in which the heaviest base finds a reversed encoder \[s\].
const UNFOUND_S: f64 = 0.74;
/// As far from its goal a base that tries again and again may be: it backs out by so much.
const BESIDE_M: f64 = 0.3;

/// Something in the loop that is broken on purpose, to see that the campaign finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mutation {
    /// Nothing.
    #[default]
    None,
    /// The driver goes on with the last torque when it is told to release or to brake.
    KeepsTorque,
    /// The brake is not connected: wheels coast.
    BrakeCoasts,
    /// Another policy.
    Policy(PolicyParams),
}

/// A tick of a run, to be looked at.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    /// World and base after the tick.
    pub rig: &'a Rig,
    /// Time \[s\].
    pub t: f64,
    /// The trouble is there.
    pub upset: bool,
    /// Way since the present stop began, and its bound.
    pub stop: Stop,
}

/// Runs a plan; `watch` sees every tick.
///
/// # Errors
/// Parameters out of their range, of a policy that is not valid for example. What the base does wrong is in
/// [`Outcome::end`].
pub fn run(
    bases: &Bases,
    plan: &Plan,
    mutation: &Mutation,
    mut watch: impl FnMut(&Tick<'_>),
) -> Result<Outcome, RigError> {
    let mut runner = Runner::new(bases, plan, *mutation)?;
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

struct Runner<'a> {
    plan: &'a Plan,
    base: &'a Base,
    mutation: Mutation,
    rig: Rig,
    bounds: Bounds,
    limit_speed: f64,
    period_s: f64,
    t: f64,
    intent: Intent,
    follow_from: f64,
    /// In place, since when.
    first: Option<f64>,
    second: Option<f64>,
    /// What of them is still there.
    active: [bool; 2],
    /// A command in this tick may lead out of a stop.
    told: bool,
    stop: Stop,
    segment: Option<Reaction>,
    dt_worst: f64,
    torque: Actuation,
    rest_s: f64,
    way_m: f64,
    outcome: Outcome,
}

type Checked<T> = Result<T, String>;

impl<'a> Runner<'a> {
    fn new(bases: &'a Bases, plan: &'a Plan, mutation: Mutation) -> Result<Self, RigError> {
        let base = bases.of(plan);
        let period_s = base.hardware.map_or(0.01, |hardware| hardware.period_s);
        let rig = Rig::of_base(base, &plan.place, |params| {
            if let Mutation::Policy(policy) = mutation {
                params.policy = policy;
            }
        })?;
        Ok(Self {
            bounds: Bounds::new(base, &plan.place, rig.base().base()),
            plan,
            base,
            mutation,
            rig,
            limit_speed: base.limits.speed,
            period_s,
            t: 0.0,
            intent: Intent::Quiet,
            follow_from: 0.0,
            first: None,
            second: None,
            active: [false; 2],
            told: false,
            stop: Stop::default(),
            segment: None,
            dt_worst: 0.0,
            torque: Actuation::Release,
            rest_s: 0.0,
            way_m: 0.0,
            outcome: Outcome::begin(plan),
        })
    }

    fn state(&self) -> State {
        self.rig.base().report().state
    }

    fn whole(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<End> {
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
        self.strike();
        let end = self.settle(watch)?;
        if self.plan.again {
            self.outcome.again = Some(self.again(watch)?);
        }
        Ok(end)
    }

    /// Drives the base into the state in which the trouble strikes.
    fn reach(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<()> {
        let target = self.plan.target;
        self.tick(watch)?;
        self.tick(watch)?;
        if target == Target::Idle {
            return Ok(());
        }
        self.command(Event::Arm)?;
        self.intent = match target {
            Target::Idle | Target::Armed => Intent::Quiet,
            Target::Parking | Target::Parked => Intent::Park(self.plan.goal),
            _ => Intent::Follow,
        };
        self.follow_from = self.t;
        let mut stopped = false;
        while Target::of(self.state()) != target {
            let followed = self.t - self.follow_from;
            if self.intent == Intent::Follow && followed > self.plan.follow_s.0 && !stopped {
                stopped = true;
                match target {
                    Target::Stopping | Target::Stopped => {
                        self.command(Event::Stop)?;
                    }
                    Target::Braking | Target::Fault => self.rig.emergency_stop(),
                    _ => {}
                }
            }
            self.tick(watch)?;
            if target == Target::Parked {
                // One that does not get to its goal parks where it stands.
                if !stopped && self.t > 0.5 * LONGEST_S.0 {
                    stopped = true;
                    self.command(Event::Stop)?;
                }
                if self.state() == State::Stopped {
                    self.command(Event::Arm)?;
                    self.intent = Intent::Park(self.pose_ahead(0.0));
                }
            }
            if self.t > LONGEST_S.0 {
                return Err(format!("never {}", target.name()));
            }
        }
        Ok(())
    }

    /// From the trouble to the end.
    fn settle(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<End> {
        let since = self.t;
        let deadline = expected::deadline_s(self.base, self.plan.target, &self.plan.upset);
        let mut stopping_since = None;
        let mut woken = !(self.plan.wake && self.plan.target.waits());
        let mut quiet_from = self.t;
        loop {
            let after = self.t - since;
            if self.active[0] && self.plan.heal_s.is_some_and(|heal| after >= heal) {
                self.heal(0);
            }
            if !woken && after >= 0.5 {
                woken = true;
                quiet_from = self.t;
                self.wake()?;
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
            self.overdue(after, deadline)?;
            if let Some(end) = self.ended(self.t - quiet_from, woken) {
                return Ok(end);
            }
            if self.t - since > LONGEST_S.1 {
                if self.beside() {
                    return Ok(End::Beside);
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
