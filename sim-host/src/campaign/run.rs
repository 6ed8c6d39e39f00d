//! One run, from power-on to its end.

use super::bounds::{Bounds, Wheels};
use super::check;
use super::expected;
use super::outcome::{Detection, End, Outcome, Stop, Violation, Why};
use super::path::narrow;
use super::plan::{Bases, Plan, Target};
use super::upset::{Upset, UpsetKind, What};
use crate::drive::{Base, Course, End as MissionEnd, Mission};
use crate::rig::{Rig, RigError};
use crate::scenario::Precision;
use crate::world::Actuation;
use controller_core::base::{Order, WheelAction};
use controller_core::safety::supervisor::{Action, Event, State};
use controller_core::safety::{FaultKind, PolicyParams, Reaction};
use controller_core::types::{Measured, Pose};

/// Longest time to drive a base into a state, and from the trouble to the end \[s\]. Parking takes up to 10 s
/// and an approach anew 12 s of patience and as much again; several of them before a goal is given up.
const LONGEST_S: (f64, f64) = (60.0, 60.0);
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
        let mission = Mission {
            name: String::new(),
            description: String::new(),
            base: base.clone(),
            robot: base.robot,
            precision: Precision::F32,
            start: Measured::default(),
            course: Course::Park(plan.goal),
            events: Vec::new(),
            period_s,
            end: MissionEnd::At(0.0),
            place: None,
        };
        let rig = Rig::with(&mission, &plan.place, |params| {
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
        let since = self.t;
        while self.t < since + self.plan.wait_s && Target::of(self.state()) == self.plan.target {
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

    /// Stopped beside the goal.
    fn gave_up(&self) -> bool {
        let report = self.rig.base().report();
        report.state == State::Stopped
            && matches!(Why::of(report.cause), Why::Fault(kind) if expected::at_any_goal(kind))
    }

    /// Still trying, close to the goal.
    fn beside(&self) -> bool {
        let (Intent::Park(goal), Some(measured)) = (self.intent, self.rig.base().report().measured)
        else {
            return false;
        };
        let (dx, dy) = (
            f64::from(measured.pose.x) - goal.x,
            f64::from(measured.pose.y) - goal.y,
        );
        let gives_up = matches!(
            Why::of(self.rig.base().report().cause),
            Why::Fault(kind) if expected::at_any_goal(kind)
        );
        (self.state() == State::Parking || gives_up) && dx.hypot(dy) < BESIDE_M
    }

    /// A command that has to be taken.
    fn command(&mut self, event: Event) -> Checked<()> {
        self.told = true;
        match self.rig.base_mut().on(event) {
            Action::Refuse => Err(format!("{event:?} is refused in {:?}", self.state())),
            _ => Ok(()),
        }
    }

    fn strike(&mut self) {
        self.first = Some(self.t);
        self.active[0] = true;
        self.outcome.at_s = self.t;
        self.way_m = 0.0;
        // A stop under way goes on with what is left from here.
        self.segment = None;
        self.plan.upset.apply(self.rig.world_mut(), true);
        if self.plan.upset.what == What::EmergencyStop {
            self.rig.emergency_stop();
        }
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

    fn strike_again(&mut self, stopping_since: Option<f64>) {
        let (Some((delay, upset)), Some(began), None) =
            (self.plan.second, stopping_since, self.second)
        else {
            return;
        };
        let stops = matches!(self.state(), State::Stopping(_) | State::Braking(_));
        // One that cannot be stopped by any command would hide what the first one does.
        if self.t < began + delay || !stops || upset.kind == UpsetKind::DriveHolds {
            return;
        }
        self.second = Some(self.t);
        self.segment = None;
        self.active[1] = true;
        self.outcome.second = Some(upset.kind);
        upset.apply(self.rig.world_mut(), true);
        if upset.what == What::EmergencyStop {
            self.rig.emergency_stop();
        }
    }

    fn upsets(&self) -> impl Iterator<Item = Upset> + use<> {
        let second = self.second.and(self.plan.second).map(|(_, upset)| upset);
        let first = self.first.map(|_| self.plan.upset);
        first.into_iter().chain(second)
    }

    fn active_upsets(&self) -> impl Iterator<Item = Upset> + use<> {
        let second = self.plan.second.map(|(_, upset)| upset);
        let first = self.active[0].then_some(self.plan.upset);
        first.into_iter().chain(second.filter(|_| self.active[1]))
    }

    fn heal(&mut self, which: usize) {
        let upset = match which {
            0 => Some(self.plan.upset),
            _ => self.plan.second.map(|(_, upset)| upset),
        };
        self.active[which] = false;
        if let Some(upset) = upset {
            upset.heal(self.rig.world_mut());
        }
        // The other may be of the same kind.
        for upset in self.active_upsets().collect::<Vec<_>>() {
            upset.apply(self.rig.world_mut(), matches!(upset.what, What::Defect(_)));
        }
        // What a driver held until now only begins to stop.
        self.segment = None;
    }

    /// Arms a base that waits, and gives it a goal.
    fn wake(&mut self) -> Checked<()> {
        if self.state() == State::Fault {
            if self.rig.base_mut().on(Event::Arm) != Action::Refuse {
                return Err("a latched base was armed".to_owned());
            }
            self.command(Event::Reset)?;
        }
        if matches!(self.state_now(), State::Idle | State::Stopped) {
            self.command(Event::Arm)?;
        }
        self.intent = Intent::Park(self.goal_ahead());
        Ok(())
    }

    fn state_now(&self) -> State {
        self.rig.base().supervisor().state()
    }

    fn goal_ahead(&self) -> Pose<f64> {
        self.pose_ahead(0.6 * self.limit_speed)
    }

    fn pose_ahead(&self, ahead: f64) -> Pose<f64> {
        let at = self
            .rig
            .base()
            .report()
            .measured
            .map_or(Pose::default(), |measured| measured.pose);
        let (x, y, theta) = (f64::from(at.x), f64::from(at.y), f64::from(at.theta));
        Pose::new(x + ahead * theta.cos(), y + ahead * theta.sin(), theta)
    }

    fn park_ahead(&mut self) {
        let path = &self.plan.path;
        let way = path.way(self.t - self.follow_from);
        let speed = path.speed;
        let ahead = speed * speed / path.accel + 0.3 * self.limit_speed;
        self.intent = Intent::Park(path.pose(way + ahead));
    }

    fn order(&mut self) -> Order<f32> {
        let nan = self.active_upsets().find_map(|upset| match upset.what {
            What::OrderNan { park } => Some(park),
            _ => None,
        });
        if let Some(park) = nan {
            // Once.
            for (active, upset) in [
                (0, Some(self.plan.upset)),
                (1, self.plan.second.map(|(_, upset)| upset)),
            ] {
                if upset.is_some_and(|upset| upset.kind == UpsetKind::OrderNan) {
                    self.active[active] = false;
                }
            }
            let pose = Pose::new(f32::NAN, 0.0, 0.0);
            return if park {
                Order::Park(pose)
            } else {
                match self.plan.path.at(0.0) {
                    Order::Follow(reference) => {
                        Order::Follow(controller_core::reference::Reference::new::<
                            controller_core::maths::Single,
                        >(
                            pose, *reference.twist(), *reference.accel()
                        ))
                    }
                    other => other,
                }
            };
        }
        let silent = self
            .active_upsets()
            .any(|upset| upset.what == What::HostSilent);
        if silent {
            return Order::None;
        }
        match self.intent {
            Intent::Quiet => {
                self.rig.base_mut().heard();
                Order::None
            }
            Intent::Follow => self.plan.path.at(self.t - self.follow_from),
            Intent::Park(goal) => Order::Park(narrow(&goal)),
        }
    }

    fn tick(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<()> {
        let before = *self.rig.base().report();
        let was = (before.state, check::severity(&before));
        for upset in self.active_upsets().collect::<Vec<_>>() {
            upset.apply(self.rig.world_mut(), false);
        }
        let place = self.rig.world().truth().pose;
        self.rig.advance().map_err(|error| error.to_string())?;
        self.t = 1.0e-6 * self.rig.world().now_us() as f64;
        let now = self.rig.world().truth();
        let moved = (now.pose.x - place.x).hypot(now.pose.y - place.y);
        self.account(moved);
        let order = self.order();
        let bad_age = self
            .active_upsets()
            .any(|upset| upset.what == What::FixAgeNan);
        let report = *self.rig.tick_with(&order, |sensed| {
            if let (true, Some(fix)) = (bad_age, &mut sensed.fix) {
                fix.age_s = f32::NAN;
            }
        });
        let limit = self.base.limits.wheel_torque_nm as f32;
        check::outputs(&report, self.rig.actuation(), limit)?;
        check::milder(was, &report, self.told)?;
        check::reacted(was.0, &report)?;
        let expected: Vec<UpsetKind> = self.upsets().map(|upset| upset.kind).collect();
        let right = |kind: FaultKind| {
            expected
                .iter()
                .any(|upset| expected::kinds(*upset).contains(&kind))
                || expected::at_any_goal(kind)
        };
        if let Some(fault) = check::wrong(&report, right) {
            let names: Vec<_> = expected.iter().map(|upset| upset.name()).collect();
            return Err(format!("{fault} is found under: {}", names.join(", ")));
        }
        self.told = false;
        self.begin_stop(&before, check::severity(&report));
        self.mutate(&report.action);
        watch(&Tick {
            rig: &self.rig,
            t: self.t,
            upset: self.active[0],
            stop: self.stop,
        });
        self.within()
    }

    /// Way and rest.
    fn account(&mut self, moved: f64) {
        let dt = 1.0e-6 * f64::from(self.rig.dt_us());
        let twist = self.rig.world().truth().twist;
        let wheels = self.rig.world().wheel_speeds();
        self.way_m += moved;
        self.stop.way_m += moved;
        self.dt_worst = self.dt_worst.max(dt);
        let rests = twist.linear.abs() < REST.0
            && twist.angular.abs() < REST.1
            && self.bounds.rolls(wheels.right, wheels.left) < 2.0 * REST.0;
        self.rest_s = if rests { self.rest_s + dt } else { 0.0 };
        if self.first.is_some() {
            self.outcome.fastest = self.outcome.fastest.max(twist.linear.abs());
        }
    }

    /// A stop begins, or another one takes over: its way is measured from here.
    fn begin_stop(&mut self, before: &controller_core::base::BaseReport<f32>, severity: Reaction) {
        let now = (severity > Reaction::RideOut).then_some(severity);
        if now == self.segment {
            return;
        }
        self.segment = now;
        let twist = self.rig.world().truth().twist;
        let wheels = Wheels {
            ice: self.upsets().find_map(|upset| upset.ice()),
            blocked: self
                .upsets()
                .any(|upset| upset.kind == UpsetKind::WheelBlocked),
        };
        let late = self
            .upsets()
            .map(|upset| upset.late_s())
            .fold(0.0, f64::max);
        let dt = 1.2 * self.period_s + late;
        let core = *self.rig.base().base();
        let bound_m = match severity {
            Reaction::RideOut => 0.0,
            Reaction::ControlledStop => {
                self.bounds.controlled(&core, before, &twist, dt, &wheels) + self.unfound_m()
            }
            Reaction::Brake => self.bounds.brake(&twist, &wheels),
            Reaction::Release => self.bounds.release(&twist, &wheels),
        };
        self.stop = Stop {
            way_m: 0.0,
            bound_m,
        };
    }

    /// A controlled stop goes by encoders; one that lies has to be found first, and the brake then takes over.
    /// Until then the base is no faster than its limit.
    fn unfound_m(&self) -> f64 {
        let lies = self.active_upsets().any(|upset| {
            matches!(
                upset.kind,
                UpsetKind::EncoderReversed | UpsetKind::EncoderStuck
            )
        });
        if lies {
            UNFOUND_S * self.limit_speed
        } else {
            0.0
        }
    }

    fn mutate(&mut self, action: &WheelAction<f32>) {
        match (self.mutation, action) {
            (_, WheelAction::Drive(_)) => self.torque = *self.rig.actuation(),
            (Mutation::KeepsTorque, _) => self.rig.override_actuation(self.torque),
            (Mutation::BrakeCoasts, WheelAction::Brake) => {
                self.rig.override_actuation(Actuation::Release);
            }
            _ => {}
        }
    }

    /// No stop goes beyond its bound, nothing runs away.
    fn within(&mut self) -> Checked<()> {
        let holds = self
            .active_upsets()
            .any(|upset| upset.kind == UpsetKind::DriveHolds);
        // Until its watchdog ends it a driver that does not listen is beyond any command.
        if holds {
            self.segment = None;
            return Ok(());
        }
        let speed = self.rig.world().truth().twist.linear.abs();
        if speed > RUNAWAY * self.limit_speed {
            return Err(format!("runs away at {speed:.2} m/s"));
        }
        if self.segment.is_some() {
            self.outcome.stop = self.outcome.stop.worse(self.stop);
            if self.stop.way_m > self.stop.bound_m {
                let Stop { way_m, bound_m } = self.stop;
                return Err(format!(
                    "{:?} goes {way_m:.3} m, beyond {bound_m:.3} m",
                    self.segment
                ));
            }
        }
        Ok(())
    }

    fn detect(&mut self, after_s: f64) {
        if self.outcome.found.is_some() {
            return;
        }
        let report = self.rig.base().report();
        let kinds = expected::kinds(self.plan.upset.kind);
        let button = self.plan.upset.kind == UpsetKind::EmergencyStop;
        let mut acted = report
            .findings
            .iter()
            .filter(|fault| kinds.contains(&fault.kind()));
        let why = acted.next().map(|fault| Why::Fault(fault.kind()));
        let why = why.or(button.then_some(Why::Button));
        self.outcome.found = why.map(|why| Detection {
            why,
            after_s,
            way_m: self.way_m,
        });
    }

    fn overdue(&self, after_s: f64, deadline_s: Option<f64>) -> Checked<()> {
        let Some(deadline) = deadline_s else {
            return Ok(());
        };
        let healed = self.plan.heal_s.is_some_and(|heal| heal < deadline);
        let woken = self.plan.upset.kind == UpsetKind::HostSilent && self.told;
        if after_s > deadline && self.outcome.found.is_none() && !healed && !woken {
            return Err(format!("not found within {deadline:.3} s"));
        }
        Ok(())
    }

    /// The end, if this is one.
    fn ended(&self, quiet_s: f64, woken: bool) -> Option<End> {
        let report = self.rig.base().report();
        let rests = self.rest_s > REST.2;
        let late = quiet_s > 1.5 && woken;
        match report.state {
            State::Stopped if rests && late && self.gave_up() && self.outcome.found.is_none() => {
                Some(End::Beside)
            }
            State::Stopped | State::Fault if rests && late => {
                Some(End::Stopped(Why::of(report.cause)))
            }
            State::Parked if rests && quiet_s > 2.5 && self.intent != Intent::Follow => {
                Some(End::Parked)
            }
            State::Idle | State::Armed if late && self.intent == Intent::Quiet => {
                rests.then_some(End::Held)
            }
            _ => None,
        }
    }

    /// Everything is mended: the base is reset, armed and goes to a new goal. Whether it parked there.
    fn again(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<bool> {
        for which in [0, 1] {
            if self.active[which] {
                self.heal(which);
            }
        }
        self.intent = match self.intent {
            Intent::Park(goal) => Intent::Park(goal),
            _ => Intent::Quiet,
        };
        let since = self.t;
        // Poses come back, batteries recover.
        while self.t < since + 1.5 {
            self.tick(watch)?;
        }
        self.wake()?;
        let since = self.t;
        loop {
            self.tick(watch)?;
            match self.state() {
                State::Parked if self.t > since + 1.0 => return Ok(true),
                State::Stopped if self.gave_up() && self.t > since + 0.5 => return Ok(false),
                State::Stopped | State::Fault if self.t > since + 0.5 => {
                    return Err(format!(
                        "mended and armed again, it stops: {:?}",
                        self.rig.base().report().cause
                    ));
                }
                _ => {}
            }
            if self.t - since > LONGEST_S.0 {
                if self.beside() {
                    return Ok(false);
                }
                return Err("mended and armed again, it does not park".to_owned());
            }
        }
    }
}
