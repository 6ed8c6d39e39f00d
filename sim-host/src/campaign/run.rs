//! One run, from power-on to its end.
//!
//! A run has a host ([`host`]), injections ([`timeline`]) and judges, each with what it remembers: of obedience
//! ([`obedience`]), of deadlines ([`deadline`]), of the way of stops ([`stops`]), of rest ([`travel`]) and of the goal
//! ([`parked`]). Here they are put in sequence.

mod deadline;
mod host;
mod mutation;
mod obedience;
mod parked;
mod stops;
mod timeline;
mod travel;

pub use mutation::Mutation;

use super::bounds::Bounds;
use super::check;
use super::outcome::{End, Failing, RunOutcome, Stop, Violation, Why};
use super::plan::{Bases, Plan, Target};
use crate::closed_loop::{Board, ClosedLoopError};
use crate::mission::BaseSpec;
use controller_core::base::BaseReport;
use controller_core::safety::supervisor::State;
use deadline::Deadline;
use firmware_demo::control_server::Queues;
use host::{BUTTON, HostOfRun, Intent};
use mutation::BrokenDriver;
use obedience::Obedience;
use parked::ParkedCheck;
use protocol::Command;
use stops::Stops;
use timeline::Timeline;
use travel::Travel;

/// Longest time to drive a base into a state, and from the trouble to the end \[s\]. Parking takes up to 10 s
/// and an approach anew 12 s of patience and as much again; three of them before a goal is given up, and a base that
/// moves about its goal, on ice for example, has several times the patience.
const LONGEST_S: (f64, f64) = (60.0, 120.0);
/// Longest time for a stop to end: the supervisor's limits of a controlled stop and of a brake, and the rest after them \[s\].
const STOP_S: f64 = 20.0;
/// So long after it parked a base has settled \[s\]: it does not go back to its goal before.
const SETTLED_S: f64 = 1.0;

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
    Ok(runner.outcome(end))
}

type Checked<T> = Result<T, String>;

struct Runner<'a, 'queue> {
    bases: &'a Bases,
    plan: &'a Plan,
    base: &'a BaseSpec,
    board: Board<'queue>,
    t: f64,
    period_s: f64,
    host: HostOfRun<'a>,
    timeline: Timeline<'a>,
    driver: BrokenDriver,
    obedience: Obedience,
    deadline: Deadline<'a>,
    stops: Stops,
    travel: Travel,
    parked: ParkedCheck,
    /// When the trouble began, and whether the base was mended and parked after its end.
    struck_s: f64,
    again: bool,
}

impl<'a, 'queue> Runner<'a, 'queue> {
    fn new(
        queues: &'queue mut Queues,
        bases: &'a Bases,
        plan: &'a Plan,
        mutation: Mutation,
    ) -> Result<Self, ClosedLoopError> {
        let base = bases.of(plan);
        let period_s = base.period_s();
        let limit_speed = base.limits.speed;
        let board = Board::new(queues, base, &plan.setup, |params| {
            if let Mutation::Policy(policy) = mutation {
                params.policy = policy;
            }
        })?;
        let bounds = Bounds::new(base, &plan.setup, board.task().controller().base());
        Ok(Self {
            bases,
            plan,
            base,
            board,
            t: 0.0,
            period_s,
            host: HostOfRun::new(plan, limit_speed),
            timeline: Timeline::new(plan),
            driver: BrokenDriver::new(mutation),
            obedience: Obedience::new(period_s),
            deadline: Deadline::new(plan, base),
            stops: Stops::new(bounds, period_s, limit_speed),
            travel: Travel::default(),
            parked: ParkedCheck::default(),
            struck_s: 0.0,
            again: false,
        })
    }

    fn outcome(&self, end: Checked<End>) -> RunOutcome {
        let second = self.plan.second.filter(|_| self.timeline.has_begun(1));
        RunOutcome {
            second: second.map(|(_, injection)| injection.kind),
            at_s: self.struck_s,
            found: self.deadline.found,
            stop: self.stops.worst,
            fastest: self.travel.fastest,
            parked: self.parked.worst,
            counted_s: self.deadline.longest_s,
            again: self.again,
            end: end.map_err(|what| Violation { at_s: self.t, what }),
            ..RunOutcome::begin(self.bases, self.plan)
        }
    }

    fn state(&self) -> State {
        self.board.report().state
    }

    fn whole(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<End> {
        self.reach(watch)?;
        let mut since = self.t;
        while self.t < LONGEST_S.0 {
            if Target::of(self.state()) != self.plan.target {
                // A parked base may go back to a goal that better poses show to be elsewhere, in the last tick of the time as well.
                if !(self.plan.target == Target::Parked && self.state() == State::Parking) {
                    break;
                }
                since = self.t;
            } else if self.t >= since + self.plan.wait_s {
                break;
            }
            self.tick(watch)?;
        }
        if Target::of(self.state()) != self.plan.target {
            return Err(format!("{:?} came before the trouble", self.state()));
        }
        if self.plan.target == Target::Parked && self.travel.parked_s >= SETTLED_S {
            self.check_parked()?;
        }
        self.struck_s = self.t;
        self.travel.strike();
        self.strike(0);
        self.host.plan_stop(self.t);
        let end = self.settle(watch)?;
        // One that is adrift is on its way yet, as is one that nothing slows down.
        if self.plan.again && self.travel.rests() && end != End::Known(Failing::Adrift) {
            self.park_again(watch)?;
            self.again = true;
        }
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
        self.host.arm();
        match target {
            Target::Idle | Target::Armed => {}
            Target::Parking | Target::Parked => self.host.park(self.plan.goal),
            _ => self.host.follow(),
        }
        let mut stopped = false;
        while Target::of(self.state()) != target {
            let due = self.host.followed_s(self.t) > self.plan.follow_s.0;
            if due && !stopped && self.host.has_it_drive(&self.board) {
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

    /// An injection of the plan begins. A stop under way goes on with what is left from here.
    fn strike(&mut self, which: usize) {
        self.stops.anew();
        if let Some(injection) = self.timeline.begin(which, self.board.world_mut()) {
            self.host.injure(&injection);
        }
    }

    /// The second injection, once a stop has begun for long enough.
    fn strike_again(&mut self, stopping_since: Option<f64>) {
        let (Some((delay, injection)), Some(began)) = (self.plan.second, stopping_since) else {
            return;
        };
        let stops = matches!(self.state(), State::Stopping(_) | State::Braking(_));
        // One that cannot be stopped by any command would hide what the first one does.
        let hides = injection.kind == super::FaultInjectionKind::DriveHolds;
        if self.t >= began + delay && stops && !hides && !self.timeline.has_begun(1) {
            self.strike(1);
        }
    }

    fn heal(&mut self, which: usize) {
        self.timeline.heal(which, self.board.world_mut());
        // What a driver held until now only begins to stop.
        self.stops.anew();
    }

    /// From the trouble to the end.
    fn settle(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<End> {
        let since = self.t;
        let mut stopping_since = None;
        let mut woken = !(self.plan.wake && self.plan.target.waits());
        let mut quiet_from = self.t;
        loop {
            let after = self.t - since;
            if self.timeline.is_active(0) && self.plan.heal_s.is_some_and(|heal| after >= heal) {
                self.heal(0);
                quiet_from = self.t;
            }
            // A host that is silent wakes nobody, and one that is about to stop a base does not either.
            if !woken && after >= 0.5 && !self.host.waits_to_stop() {
                woken = true;
                quiet_from = self.t;
                self.host.wake(&self.board, &self.timeline.manner());
            }
            if self.host.stops_when_due(self.t) {
                quiet_from = self.t;
            }
            if self.plan.target == Target::Tracking
                && self.host.intent == Intent::Follow
                && after > self.plan.follow_s.1
            {
                self.host.park_ahead(self.t, &self.board);
            }
            let stops = matches!(self.state(), State::Stopping(_) | State::Braking(_));
            if stops && stopping_since.is_none() {
                stopping_since = Some(self.t);
            }
            self.strike_again(stopping_since);
            self.tick(watch)?;
            self.deadline.detect(
                self.board.report(),
                self.host.refused,
                after + self.period_s,
                self.travel.way_m,
            );
            self.deadline.check(&self.board, &self.timeline)?;
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
                // Parked by then, but not for long enough to be called settled, is adrift as well.
                let here = matches!(self.state(), State::Parking | State::Parked);
                if here && self.timeline.is_known(Failing::Adrift) {
                    return Ok(End::Known(Failing::Adrift));
                }
                return Err(format!(
                    "neither parked nor stopped: {:?}, resting for {:.1} s",
                    self.state(),
                    self.travel.rest_s
                ));
            }
        }
    }

    /// The end, if this is one.
    fn ended(&mut self, quiet_s: f64, woken: bool) -> Checked<Option<End>> {
        let report = self.board.report();
        let (state, cause) = (report.state, report.cause);
        let rests = self.travel.rests();
        // Released, a base without dry friction rolls on: no way is too long for it.
        let coasts = self.stops.present().bound_m.is_infinite();
        let late = quiet_s > 1.5
            && woken
            && !self.host.waits_to_stop()
            && (self.host.is_content() || self.timeline.manner().silent);
        Ok(match state {
            State::Stopped | State::Fault if late && (rests || coasts) => {
                Some(End::Stopped(Why::of(cause)))
            }
            State::Parked
                if rests
                    && quiet_s > 2.5
                    && self.travel.parked_s > SETTLED_S
                    && self.host.intent != Intent::Follow =>
            {
                self.check_parked()?;
                Some(End::Parked)
            }
            State::Idle | State::Armed if late && self.host.intent == Intent::Quiet => {
                rests.then_some(End::Held)
            }
            _ => None,
        })
    }

    /// A base that says it is parked, at the goal that the host gave it.
    fn check_parked(&mut self) -> Checked<()> {
        let Intent::Park(goal) = self.host.intent else {
            return Ok(());
        };
        let bounds = self.stops.bounds();
        self.parked
            .check(&goal, self.base, &self.board, bounds, &self.timeline)
    }

    /// Everything is mended: the base is reset, armed, goes to a new goal and parks.
    fn park_again(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<()> {
        for which in [0, 1] {
            if self.timeline.is_active(which) {
                self.heal(which);
            }
        }
        let since = self.t;
        // Poses come back, batteries recover.
        while self.t < since + 1.5 {
            self.tick(watch)?;
        }
        // What was wrong is over: from here on nothing is to be found any more.
        self.timeline.all_mended();
        self.host.wake(&self.board, &self.timeline.manner());
        let since = self.t;
        loop {
            self.tick(watch)?;
            match self.state() {
                State::Parked if self.travel.parked_s > SETTLED_S && self.host.is_content() => {
                    return self.check_parked();
                }
                State::Stopped | State::Fault if self.t > since + 0.5 => {
                    return Err(format!(
                        "mended and armed again, it stops: {:?}",
                        self.board.report().cause
                    ));
                }
                _ => {}
            }
            if self.t - since > LONGEST_S.0 {
                return Err("mended and armed again, it does not park".to_owned());
            }
        }
    }

    /// A tick of world, host and base, and what is checked in it.
    fn tick(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<()> {
        let before = applied(&self.board);
        let was = (before.state, check::severity(&before));
        self.timeline.apply(self.board.world_mut());
        let place = self.board.world().truth().pose;
        self.board.advance().map_err(|error| error.to_string())?;
        self.t = 1.0e-6 * self.board.world().now_us() as f64;
        let now = self.board.world().truth();
        let moved = (now.pose.x - place.x).hypot(now.pose.y - place.y);
        self.travel.account(&self.board, self.stops.bounds(), moved);
        self.stops.moved(moved);
        let manner = self.timeline.manner();
        let mutation = &self.driver.mutation;
        self.host.exchange(&mut self.board, &manner, mutation);
        self.board.tick();
        self.host.answers(&mut self.board, &manner)?;
        let report = applied(&self.board);
        let received = &self.host.received;
        self.obedience.check(&self.board, received, &report)?;
        let limit = self.base.limits.wheel_torque_nm as f32;
        check::outputs(&report, self.board.actuation(), limit)?;
        check::milder(was, &report, received)?;
        check::reacted(was.0, &report)?;
        if let Some(why) = check::wrong(&before, &report, |why| self.timeline.allows(why)) {
            return Err(format!("{why} is found, which it is not"));
        }
        self.deadline
            .count(&self.board, &self.timeline, &before, received.read);
        let severity = check::severity(&report);
        self.stops
            .begin(&self.board, &self.timeline, &before, severity);
        self.driver.act(&mut self.board, &report.action);
        watch(&Tick {
            board: &self.board,
            t: self.t,
            injection: self.timeline.is_active(0),
            stop: self.stops.present(),
        });
        let speed = self.board.world().truth().twist.linear.abs();
        self.stops.check(speed, &self.timeline)
    }
}

/// The report of the last tick, with what was really applied to the wheels: after a driver's error they are released.
fn applied(board: &Board<'_>) -> BaseReport<f32> {
    BaseReport {
        action: *board.task().output(),
        ..*board.report()
    }
}
