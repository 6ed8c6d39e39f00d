//! The tick: from a pose to wheel torques.

use nalgebra::{Vector2, Vector3};

use super::arrival::{Attempts, Latch, STOPPING, View, stalled_for};
use super::command::{Command, Desired, faded, offset, set_back, share, wrench};
use super::constants::Constants;
use super::disturbance::Observer;
use super::feedback::Regulator;
use super::follow::{Follower, Sample, error};
use super::velocity::Heading;
use super::{Pair, follow};

/// How often attempts at a goal are forgotten because the pose jumped.
const JUMPS: u8 = 3;

/// What the robot is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// Follow.
    Follow(Sample),
    /// Park at a posture.
    Park(Vector3<f64>),
    /// Drive, with the heading held or not.
    Drive(Pair, bool),
}

/// What is measured in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Posture.
    pub q: Vector3<f64>,
    /// (v, w).
    pub twist: Pair,
}

/// What a tick makes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Pose error.
    pub e: Vector3<f64>,
    /// Of the pose law.
    pub desired: Desired,
    /// b.
    pub offset: Pair,
    /// Of the governor.
    pub command: Command,
    /// d̂.
    pub disturbance: Pair,
    /// σ.
    pub load: Pair,
    /// Before the wheels' limit.
    pub wrench: Pair,
    /// Right, left.
    pub torques: Vector2<f64>,
    /// Speed, acceleration, jerk, torque, disturbance.
    pub limited: [bool; 5],
    /// A jump was taken.
    pub jumped: bool,
    /// Parked, given up, stalled.
    pub outcome: [bool; 3],
    /// Backing up while parking.
    pub backing: bool,
    /// New approaches.
    pub retries: u8,
}

/// The law with all that it remembers.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    k: Constants,
    task: Task,
    follower: Follower,
    regulator: Regulator,
    /// A setpoint is faster at a rim than it may be: of a tie, in the next tick.
    beyond_rim: Option<bool>,
    /// Feedback has a plan of its own: none, until the first tick.
    parks: bool,
    latch: Latch,
    attempts: Attempts,
    /// Jumps of the pose that attempts were forgotten for.
    jumps: u8,
    heading: Heading,
    stalled: f64,
    observer: Observer,
    offset: (Pair, Pair),
    command: Command,
    declared: bool,
    released: bool,
    last: Row,
}

/// How what is desired goes on from the command.
enum From {
    Last,
    Offset,
    Command,
}

fn same(a: &Task, b: &Task) -> bool {
    match (a, b) {
        (Task::Follow(_), Task::Follow(_)) | (Task::Drive(..), Task::Drive(..)) => true,
        (Task::Park(a), Task::Park(b)) => a == b,
        _ => false,
    }
}

/// Speeds below this are at rest but for the roundings of some ticks, and rims nearer to their limit, as a share of it, at that.
const TIE: f64 = 1e-12;

impl Law {
    /// The first command is the measured twist.
    pub fn start(k: Constants, task: Task, now: &Inputs) -> (Self, Row) {
        let command = Command::of_robot(&k, &now.twist);
        let mut law = Self {
            k,
            task,
            follower: Follower::default(),
            regulator: Regulator::default(),
            beyond_rim: None,
            parks: false,
            latch: Latch::default(),
            attempts: Attempts::default(),
            jumps: 0,
            heading: Heading::default(),
            stalled: 0.0,
            observer: Observer {
                twist: now.twist,
                ..Observer::default()
            },
            offset: (Pair::zeros(), Pair::zeros()),
            command,
            declared: false,
            released: false,
            last: Row::default(),
        };
        let e = law.error(&task, now, 0.0);
        let (desired, _) = law.pose_law(&task, true, &e, now, &command, None, 0.0);
        law.offset = offset(&command, &desired, 1.0, 0.0);
        let row = Row {
            e,
            desired,
            jumped: true,
            ..Row::default()
        };
        let row = law.torque(row, command, now, 0.0);
        (law, row)
    }

    /// Goes on from what another law did in the tick: its `command`, its estimates, and what its wheels exert.
    pub fn take_over(
        &mut self,
        command: &Command,
        (d, load): (Pair, Pair),
        torques: &Vector2<f64>,
        twist: &Pair,
    ) {
        let k = self.k;
        let exerted = k.wheels_to_wrench() * torques;
        (self.observer.d, self.observer.load) = (d, load);
        self.observer.exerted = Some(exerted);
        self.command = Command {
            twist: set_back(&k, command, twist, &exerted, (&d, &load)),
            rate: command.rate,
        };
    }

    /// The law with either answer to what rounding says for it: the sign of an axis whose command is at rest, whether a wheel's rim that
    /// goes on at its limit is beyond it. As it is if there is none.
    pub fn ties(&self) -> Vec<Self> {
        let mut laws = vec![*self];
        for axis in 0..2 {
            if self.command.twist[axis].abs() < TIE {
                let mut other = laws.clone();
                for (laws, sign) in [(&mut laws, 1.0), (&mut other, -1.0)] {
                    laws.iter_mut()
                        .for_each(|law| law.command.twist[axis] = sign * f64::MIN_POSITIVE);
                }
                laws.append(&mut other);
            }
        }
        if (self.k.rim(&self.command.twist) / self.k.rim_speed - 1.0).abs() < TIE {
            let mut other = laws.clone();
            for (laws, beyond) in [(&mut laws, false), (&mut other, true)] {
                laws.iter_mut()
                    .for_each(|law| law.beyond_rim = Some(beyond));
            }
            laws.append(&mut other);
        }
        laws
    }

    /// The pose will jump.
    pub fn declare_jump(&mut self) {
        self.declared = true;
    }

    /// What wheels (right, left) exert until the next tick; `None`: nobody knows. Where one misses more than a quarter of what was asked and a
    /// hundredth of its limit, the command becomes what the robot does.
    pub fn note(&mut self, torques: Option<Vector2<f64>>) {
        let (k, last) = (self.k, self.last);
        self.observer.exerted = torques.map(|torques| k.wheels_to_wrench() * torques);
        let Some(torques) = torques else { return };
        let along = torques.component_mul(&last.torques.map(f64::signum));
        let missed = 0.75 * last.torques.abs() - along;
        if missed.max() > 0.01 * k.torque {
            let heavier = k.inertia.component_mul(&last.load.add_scalar(1.0));
            let driving = k.wheels_to_wrench() * torques + last.disturbance;
            let robot = Command::of_robot(&k, &self.observer.twist);
            self.command = Command {
                rate: robot.within_accel(&k, &driving.component_div(&heavier)),
                ..robot
            };
            self.last.limited[3] = true;
        }
    }

    /// A tick of `dt`.
    pub fn tick(&mut self, task: Task, now: &Inputs, dt: f64) -> Row {
        let k = self.k;
        let new = !same(&task, &self.task);
        let command = if self.released {
            Command::of_robot(&k, &now.twist)
        } else {
            self.command
        };
        let fades = self.rests(&self.task) && k.release;
        let at_bound = self
            .observer
            .advance(&k, &now.twist, &command.rate, fades, dt);
        let e = match task {
            Task::Drive(..) => Vector3::new(0.0, 0.0, self.heading.error(&command, now.q.z, dt)),
            _ => self.error(&task, now, dt),
        };
        let jumped = new || self.declared || self.has_jumped(&task, &e, dt);
        let was_parking = matches!(self.task, Task::Park(_));
        if new && matches!(task, Task::Park(_)) {
            self.attempts = Attempts::default();
            self.parks = false;
            self.jumps = 0;
            if !was_parking {
                self.latch = Latch::default();
            }
        }
        let since = (!jumped).then_some(dt);
        let (desired, from) = self.pose_law(&task, jumped, &e, now, &command, since, dt);
        let rests = self.rests(&task);
        self.offset = match from {
            From::Command => (Pair::zeros(), Pair::zeros()),
            From::Offset => {
                let again = jumped && self.last.jumped;
                let kept = if again { (-2.0 * k.a * dt).exp() } else { 1.0 };
                offset(&command, &desired, kept, dt)
            }
            From::Last => {
                let decay = if rests { STOPPING } else { k.a };
                faded(&self.offset.0, &self.offset.1, &Pair::repeat(decay), dt)
            }
        };
        self.released &= rests;
        let reduced = self.beyond_rim.take();
        let (command, [speed, accel, jerk]) = if self.released {
            (command, [false; 3])
        } else {
            let to = Desired {
                twist: desired.twist + self.offset.0,
                rate: desired.rate + self.offset.1,
            };
            command.after(&k, &to, reduced, dt)
        };
        let beyond = matches!(task, Task::Drive(order, _) if k.reachable(&order) != order);
        self.stalled = stalled_for(
            &k,
            self.stalled,
            &command.twist,
            &now.twist,
            self.last.limited[3],
            dt,
        );
        (self.task, self.declared) = (task, false);
        let row = Row {
            e,
            desired,
            limited: [speed || beyond, accel, jerk, false, at_bound],
            jumped,
            ..Row::default()
        };
        self.torque(row, command, now, dt)
    }

    fn error(&self, task: &Task, now: &Inputs, _: f64) -> Vector3<f64> {
        match task {
            Task::Follow(sample) => error(&sample.q, &now.q),
            Task::Park(goal) => error(goal, &now.q),
            Task::Drive(..) => Vector3::zeros(),
        }
    }

    fn has_jumped(&self, task: &Task, e: &Vector3<f64>, dt: f64) -> bool {
        let Some((far, turned)) = self.k.jump else {
            return false;
        };
        let last = &self.last.e;
        let reference = match task {
            Task::Follow(sample) => sample.twist.x.abs(),
            _ => 0.0,
        };
        let moves = self.k.speed.x + reference + self.k.speed.y * last.xy().norm();
        (e - last).xy().norm() > far + dt * moves
            || follow::wrapped(e.z - last.z).abs() > turned + 2.0 * dt * self.k.speed.y
    }

    fn rests(&self, task: &Task) -> bool {
        matches!(task, Task::Park(_)) && (self.latch.parked || self.attempts.given_up)
    }

    #[allow(clippy::too_many_arguments)]
    fn pose_law(
        &mut self,
        task: &Task,
        jumped: bool,
        e: &Vector3<f64>,
        now: &Inputs,
        command: &Command,
        since: Option<f64>,
        dt: f64,
    ) -> (Desired, From) {
        let k = self.k;
        let or_offset = |since: Option<f64>| {
            if since.is_some() {
                From::Last
            } else {
                From::Offset
            }
        };
        match task {
            Task::Follow(sample) => {
                let turn_rate = now.twist.y;
                let desired =
                    self.follower
                        .desired(&k, sample, e, turn_rate, &command.twist, since);
                (desired, or_offset(since))
            }
            Task::Drive(order, hold) => {
                let measured = (now.q.z, now.twist.y);
                let desired = self
                    .heading
                    .desired(&k, order, *hold, measured, e.z, command, jumped, dt);
                (desired, From::Command)
            }
            Task::Park(_) => {
                let was_parked = self.latch.parked;
                if jumped && self.parks && !self.attempts.given_up && self.jumps < JUMPS {
                    self.jumps += 1;
                    self.attempts = Attempts::default();
                }
                let was_resting = was_parked || self.attempts.given_up;
                let at = View {
                    e: *e,
                    twist: now.twist,
                    command,
                    backs: self.regulator.way < 0.0,
                };
                self.latch = match (self.attempts.may_park(), since) {
                    (false, _) => Latch::default(),
                    (true, Some(_)) => self.latch.after(&k, &at, dt),
                    (true, None) => Latch::default().after(&k, &at, dt),
                };
                if self.latch.parked {
                    self.jumps = 0;
                }
                let lost = was_parked && since.is_some() && !self.latch.parked;
                let afresh = self.attempts.advance(&k, &at, &self.latch, lost, dt);
                if self.latch.parked || self.attempts.given_up {
                    self.regulator.rest();
                    let goes_on = was_resting && since.is_some();
                    let from = if goes_on { From::Last } else { From::Offset };
                    return (Desired::default(), from);
                }
                if dt == 0.0 {
                    let desired = Desired {
                        twist: command.twist,
                        rate: Pair::zeros(),
                    };
                    return (desired, From::Offset);
                }
                let begins = !self.parks || afresh || was_resting;
                self.parks = true;
                let since = since.filter(|_| !begins);
                let aim = self.attempts.aim(&k, e);
                let desired = self.regulator.desired(&k, &aim, &command.twist, since);
                (desired, or_offset(since))
            }
        }
    }

    /// Torque for a command, the wheels' limit, and what that does to the command.
    fn torque(&mut self, row: Row, command: Command, now: &Inputs, dt: f64) -> Row {
        let k = self.k;
        let (d, load) = (self.observer.d, self.observer.load);
        let asked = wrench(&k, &command, &now.twist, (&d, &load));
        let factors = share(&k, &asked, k.torque);
        let (exerted, saturated) = (factors.component_mul(&asked), factors != Pair::repeat(1.0));
        self.command = command;
        if saturated {
            self.command.twist = set_back(&k, &command, &now.twist, &exerted, (&d, &load));
        }
        let rests = self.rests(&self.task) && k.release;
        // Section 7: what is left of its speed a robot that is let go keeps where no friction stops it.
        let still = |pair: &Pair| pair.amax() < 1e-4;
        let off = now.twist - command.twist;
        let step = k.wrench_rate_limit() * dt - asked.abs();
        let stands = still(&self.command.twist) && still(&off) && step.min() >= 0.0;
        self.released = rests && (self.released || stands);
        self.observer.exerted = (!self.released).then_some(exerted);
        let parks = matches!(self.task, Task::Park(_));
        let parked = parks && self.latch.parked;
        let given_up = parks && !parked && self.attempts.given_up;
        let mut limited = row.limited;
        limited[3] = saturated;
        let to_wheels = k
            .wheels_to_wrench()
            .try_inverse()
            .expect("wheels of some size");
        let torques = if self.released {
            Vector2::zeros()
        } else {
            to_wheels * exerted
        };
        let row = Row {
            offset: self.offset.0,
            command,
            disturbance: d,
            load,
            wrench: asked,
            torques,
            limited,
            outcome: [
                parked,
                given_up,
                !parked && !given_up && self.stalled > k.stall.1,
            ],
            backing: parks && self.regulator.way < 0.0,
            retries: if parks { self.attempts.count } else { 0 },
            ..row
        };
        self.last = row;
        row
    }
}
