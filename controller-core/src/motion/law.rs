//! One tick from pose to wheel torques. Parameters and report are lent: they exist once, wherever the law is built in.

use super::arrival::AtRest;
use super::disturbance::{Observer, Watch};
use super::drive::{self, DriveLaw};
use super::error_view::ErrorView;
use super::follow::Follower;
use super::goal_checker::{Pushing, STOPPING_DECAY, Stall};
use super::governor::Command;
use super::params::ValidMotionParams;
use super::parking::ParkingLaw;
use super::pose_law::{Moving, Step, Transition, Wanted};
use super::report::{Limited, Mode, MotionReport, Outcome};
use super::saturation::share;
use super::setpoint::Setpoint;
use super::task::{Asked, Task};
use super::transition_offset::TransitionOffset;
use super::velocity_loop::{achieved, stands, wrench};
use crate::check::check_tick;
use crate::error::{Input, StepFault};
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::clamp;
use crate::robot::acceleration;
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::shunting::NeuronUpdate;
use crate::types::{Measured, Twist, WheelTorques, Wrench};
use core::marker::PhantomData;

/// How far off its goal or its reference a robot may be, and how fast, added up \[m, m/s, rad/s\]: beyond two poses that may be
/// [stated](crate::types::FARTHEST_M), as which of another frame or unit would have a robot drive away. Nothing that parking makes of less overflows, whatever
/// the parameters are: such a tick is not refused after it has changed a manoeuvre, which so need not be kept to be brought back.
const REACH: f64 = 1.0e4;

/// Largest force and moment that are noted, added up \[N, N m\]: of less nothing overflows.
const MOST_NOTED: f64 = 1.0e9;

/// Largest torque of a wheel that is noted, in limits of the parameters. A driver exerts less than it is asked for, or, while it brakes wheels that are
/// turned faster than its supply turns them, what its current limit allows: a few times the limit. Torques in another unit, N cm or N mm, are
/// beyond it from a tenth of the limit on: believed, they would be taken for accelerations that are not there, and the base would run away.
const MOST_EXERTED: f64 = 10.0;

/// What a wheel may be said to exert less than it was asked for before that is taken for a limit of its driver: a share of what was asked,
/// by which the constant of a motor may be off whose current is measured (data sheets state 10 %, warm magnets lose as much again), and a share of the
/// parameters' limit for the measurement's noise. A base whose command is set back in every tick gets nowhere.
const ASTRAY: f64 = 0.25;
const NOISE: f64 = 0.01;

/// What the law remembers from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotionLaw<T, M, U> {
    follower: Follower<T>,
    parking: ParkingLaw<T>,
    drive: DriveLaw<T>,
    stall: Stall<T>,
    observer: Observer<T>,
    /// What the wheels exert until the next tick; `None` if nobody knows, or they are not driven.
    exerted: Option<Wrench<T>>,
    offset: TransitionOffset<T>,
    command: Command<T>,
    /// The caller said that the pose will jump.
    declared: bool,
    /// Parked without torque: the command is what the robot does by itself.
    released: bool,
    back_ends: PhantomData<(M, U)>,
}

/// Of a task that is another one than in the last tick.
#[derive(Clone, Copy)]
struct Renewed {
    /// That parked already, at another goal.
    goes_on: bool,
}

/// What the law of the task makes of a tick.
struct Desired<T> {
    wanted: Wanted<T>,
    /// Nothing is asked for any more.
    resting: bool,
    /// The order is beyond the limits, and driven at the limits.
    beyond: bool,
    /// Of what the law remembers. The follower's is in the setpoint, which is its own along manoeuvres as well.
    residue: T,
}

impl<T: Scalar> Desired<T> {
    /// Of a law that the robot moves by, all of it in what is `wanted`.
    #[inline(always)]
    const fn moving(wanted: Wanted<T>) -> Self {
        Self {
            wanted,
            resting: false,
            beyond: false,
            residue: T::ZERO,
        }
    }
}

/// What a tick found on its way to the torque.
struct Found<'a, T> {
    task: &'a Task<T>,
    error: PoseError<T>,
    setpoint: Setpoint<T>,
    limited: Limited,
    jumped: bool,
    /// Nothing is asked for any more.
    resting: bool,
    /// Residue of what law and observer remember.
    remembered: T,
    /// Parked without torque until now, and still.
    released: bool,
    offset: TransitionOffset<T>,
    command: Command<T>,
    stall: Stall<T>,
    observer: &'a Observer<T>,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> MotionLaw<T, M, U> {
    /// Nothing seen, nothing asked for.
    pub(crate) const IDLE: Self = Self {
        follower: Follower::NEW,
        parking: ParkingLaw::NEW,
        drive: DriveLaw::NEW,
        stall: Stall::NEW,
        observer: Observer::NEW,
        exerted: None,
        offset: TransitionOffset::NONE,
        command: Command::REST,
        declared: false,
        released: false,
        back_ends: PhantomData,
    };

    /// Becomes [`IDLE`](Self::IDLE), without a copy of the room that a manoeuvre takes.
    fn forget(&mut self) {
        let Self {
            follower,
            parking,
            drive,
            stall,
            observer,
            exerted,
            offset,
            command,
            declared,
            released,
            back_ends: _,
        } = self;
        parking.forget();
        (*follower, *drive) = (Follower::NEW, DriveLaw::NEW);
        (*stall, *observer, *exerted) = (Stall::NEW, Observer::NEW, None);
        (*offset, *command) = (TransitionOffset::NONE, Command::REST);
        (*declared, *released) = (false, false);
    }

    /// Starts from any pose and twist; see [`MotionController::start`](super::MotionController::start).
    ///
    /// # Errors
    /// An input that is not finite, or so large that a torque is not. The law is then as good as idle.
    pub(crate) fn begin(
        &mut self,
        motion: &ValidMotionParams<T>,
        task: &Task<T>,
        measured: &Measured<T>,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        task.check()?;
        self.forget();
        let view = ErrorView::of::<M>(task, &measured.pose, || T::ZERO);
        let observer = Observer::start(&measured.twist);
        let observed = observer.residue();
        if !is_within_reach(&view.error, &measured.twist, observed) {
            return Err(StepFault::Overflow);
        }
        let command = Command::of_robot(motion, &measured.twist);
        let step = Step {
            dt: T::ZERO,
            two_per_dt: None,
        };
        let now = (measured, &command);
        let renewed = Some(Renewed { goes_on: false });
        let Desired {
            wanted: desired,
            resting,
            residue,
            ..
        } = self.pose_law(motion, (task, renewed), &view, now, step);
        let found = Found {
            task,
            error: view.error,
            setpoint: desired.setpoint,
            limited: Limited::default(),
            jumped: true,
            resting,
            remembered: residue + observed,
            released: false,
            offset: TransitionOffset::between(&command, &desired.setpoint, T::ONE, T::ZERO),
            command,
            stall: Stall::NEW,
            observer: &observer,
        };
        self.finish(motion, found, &measured.twist, T::ZERO, report)
    }

    /// One tick, `dt` \[s\] after the last, whose `report` becomes that of this one. What is `measured` goes into errors and
    /// torque, but for the place of a robot that drives by velocity: where it is not finite they are not, and the tick is refused for that.
    ///
    /// # Errors
    /// Any [`StepFault`]; law and report are then unchanged, and the wheels are the caller's to make safe.
    pub(crate) fn step(
        &mut self,
        motion: &ValidMotionParams<T>,
        dt: T,
        asked: Asked<'_, T>,
        measured: &Measured<T>,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        check_tick(dt, motion.params().max_tick_s)?;
        let task = asked.task;
        // All of a reference and of a goal goes into error and setpoint: they are looked at if those are not finite.
        if matches!(task, Task::Drive { .. }) {
            task.check()?;
        }
        let new = asked.is_new(report.mode);
        // What changes before it is known whether the tick is refused.
        let (follower, drive) = (self.follower, self.drive);
        let mut observer = self.observer;
        let mut command = if self.released {
            Command::of_robot(motion, &measured.twist)
        } else {
            self.command
        };
        let parked = report.mode == Mode::Parking;
        let watch = if parked && self.parking.is_resting() && motion.releases() {
            Watch::Fade
        } else {
            Watch::Observe
        };
        let bounded = observer.advance(
            motion,
            &measured.twist,
            &command.rate,
            watch,
            self.exerted.as_ref(),
            dt,
        );
        let view = ErrorView::of::<M>(task, &measured.pose, || {
            self.drive.turn_on(&command, dt);
            self.drive.error(measured.pose.theta)
        });
        let jumped =
            new || self.declared || view.has_jumped::<M>(&report.error, motion.params(), dt);
        let step = Step {
            dt,
            two_per_dt: if jumped {
                None
            } else {
                Some((T::ONE + T::ONE) / dt)
            },
        };
        let now = (measured, &command);
        let renewed = new.then_some(Renewed { goes_on: parked });
        let observed = observer.residue();
        let parks = matches!(task, Task::Park(_));
        // No reference gets there without a jump.
        if (parks || jumped) && !is_within_reach(&view.error, &measured.twist, observed) {
            task.check()?;
            return Err(StepFault::Overflow);
        }
        let Desired {
            wanted: desired,
            resting,
            beyond,
            residue,
        } = self.pose_law(motion, (task, renewed), &view, now, step);
        let offset = match desired.transition {
            Transition::Seamless => TransitionOffset::NONE,
            Transition::Offset => {
                let kept = Self::kept(motion, jumped && report.jumped, dt);
                TransitionOffset::between(&command, &desired.setpoint, kept, dt)
            }
            Transition::Continue => {
                let decay = if resting {
                    T::from_f64(STOPPING_DECAY)
                } else {
                    motion.gains().decay
                };
                let fade = T::ONE + M::exp_m1(-(decay * dt));
                self.offset.advance(decay, dt, fade)
            }
        };
        let released = self.released && resting;
        let mut limited = if released {
            Limited::default()
        } else {
            let limited;
            let setpoint = offset.added_to(&desired.setpoint);
            (command, limited) = command.advance(motion, &setpoint, dt);
            limited
        };
        limited.disturbance = bounded;
        limited.speed |= beyond;
        let pushing = Pushing {
            command: command.twist,
            twist: measured.twist,
            saturated: report.limited.torque,
        };
        let found = Found {
            task,
            error: view.error,
            setpoint: desired.setpoint,
            limited,
            jumped,
            resting,
            remembered: residue + observed,
            released,
            offset,
            command,
            stall: self.stall.advance(motion, &pushing, dt),
            observer: &observer,
        };
        let finished = self.finish(motion, found, &measured.twist, dt, report);
        if finished.is_err() {
            (self.follower, self.drive) = (follower, drive);
            if parks {
                // Within reach none is known. What is no number must not stay.
                self.parking.forget();
            }
            task.check()?;
        }
        finished
    }

    /// The law of the task. A `renewed` goal is parked at anew.
    #[inline(always)]
    fn pose_law(
        &mut self,
        motion: &ValidMotionParams<T>,
        (task, renewed): (&Task<T>, Option<Renewed>),
        view: &ErrorView<T>,
        (measured, command): (&Measured<T>, &Command<T>),
        step: Step<T>,
    ) -> Desired<T> {
        let moving = Moving {
            twist: &measured.twist,
            command,
        };
        match task {
            Task::Follow(reference) => {
                let two_per_dt = step.two_per_dt;
                Desired::moving(
                    self.follower
                        .follow::<U, M>(motion, reference, view, moving, two_per_dt),
                )
            }
            Task::Park(_) => {
                if let Some(renewed) = renewed {
                    self.parking.renew(renewed.goes_on);
                }
                // One of its own, that is lent: that of other tasks stays in registers.
                let view = *view;
                let follower = &mut self.follower;
                Desired {
                    wanted: self
                        .parking
                        .advance::<U, M>(follower, motion, &view, moving, step),
                    resting: self.parking.is_resting(),
                    beyond: false,
                    residue: self.parking.residue(),
                }
            }
            Task::Drive {
                twist,
                hold_heading,
            } => {
                let now = drive::Now {
                    order: twist,
                    hold_heading: *hold_heading,
                    heading: measured.pose.theta,
                    turn_rate: measured.twist.angular,
                    error: view.error.theta,
                    command,
                    jumped: step.two_per_dt.is_none(),
                    dt: step.dt,
                };
                let wanted = Wanted {
                    setpoint: self.drive.advance::<M>(motion, &now),
                    transition: Transition::Seamless,
                };
                Desired {
                    beyond: motion.reachable(twist) != *twist,
                    residue: self.drive.residue(),
                    ..Desired::moving(wanted)
                }
            }
        }
    }

    /// The next pose jumps; see [`MotionController::declare_jump`](super::MotionController::declare_jump).
    pub(crate) const fn declare_jump(&mut self) {
        self.declared = true;
    }

    /// Wheels slide; see [`MotionController::declare_slide`](super::MotionController::declare_slide).
    pub(crate) fn declare_slide(&mut self) {
        self.parking.declare_slide();
    }

    /// See [`ParkingLaw::is_beside`].
    pub(crate) fn is_beside_goal(&self) -> bool {
        self.parking.is_beside()
    }

    /// What the wheels really exert until the next tick, instead of what the last `report` asks for; see
    /// [`MotionController::note_applied`](super::MotionController::note_applied).
    ///
    /// # Errors
    /// A torque that is not finite, or above [`MOST_EXERTED`]; nothing is noted then.
    pub(crate) fn note_applied(
        &mut self,
        motion: &ValidMotionParams<T>,
        applied: &WheelTorques<T>,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        let exerted = motion.wheels.wrench(applied);
        let most = T::from_f64(MOST_EXERTED) * motion.params().limits.wheel_torque_nm;
        let is_a_wheels = applied.right.abs() <= most && applied.left.abs() <= most;
        if is_a_wheels && exerted.force.abs() + exerted.moment.abs() < T::from_f64(MOST_NOTED) {
            self.exerted = Some(exerted);
            self.set_back(motion, applied, report);
            Ok(())
        } else if applied.right.is_finite() && applied.left.is_finite() {
            Err(StepFault::OutOfRange(Input::Applied))
        } else {
            Err(StepFault::NotFinite(Input::Applied))
        }
    }

    /// Where a wheel is `applied` less than it was asked for the command goes on from how the robot moves: it does not wind up where a driver is at
    /// its limit.
    fn set_back(
        &mut self,
        motion: &ValidMotionParams<T>,
        applied: &WheelTorques<T>,
        report: &mut MotionReport<T>,
    ) {
        let noise = T::from_f64(NOISE) * motion.params().limits.wheel_torque_nm;
        // Not where it exerts more: of a driver that runs away the velocity loop is not to give in to.
        let short = |asked: T, applied: T| {
            let (asked, along) = (
                asked.abs(),
                if asked < T::ZERO { -applied } else { applied },
            );
            T::from_f64(1.0 - ASTRAY) * asked - along > noise
        };
        let asked = &report.torques;
        if short(asked.right, applied.right) || short(asked.left, applied.left) {
            let (command, error) = (&report.command, &report.velocity_error);
            let twist = Twist {
                linear: command.linear + error.linear,
                angular: command.angular + error.angular,
            };
            let Wrench { force, moment } = motion.wheels.wrench(applied);
            let driving = Wrench {
                force: force + report.disturbance.force,
                moment: moment + report.disturbance.moment,
            };
            let accel = acceleration(&motion.params().robot, &driving);
            self.command = Command::of_moving(motion, &twist, &report.load.slowed(&accel));
            report.limited.torque = true;
        }
    }

    /// Until the next tick the wheels are not driven.
    pub(crate) fn note_not_driven(&mut self) {
        self.exerted = None;
    }

    /// How much of its rate the command keeps in a tick that jumps: all of it, unless the last tick
    /// jumped too. A goal that moves at every tick must not keep the robot from answering.
    fn kept(motion: &ValidMotionParams<T>, again: bool, dt: T) -> T {
        if again {
            let decay = motion.gains().decay;
            T::ONE + M::exp_m1(-((decay + decay) * dt))
        } else {
            T::ONE
        }
    }

    /// The end of a tick: torque for the command with the measured `twist`, the wheels' limit and what it does to the
    /// command, the report. Everything that was found is kept, unless it is not finite.
    #[inline(always)]
    fn finish(
        &mut self,
        motion: &ValidMotionParams<T>,
        found: Found<'_, T>,
        twist: &Twist<T>,
        dt: T,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        let limits = &motion.params().limits;
        let command = found.command;
        let velocity_error = twist.minus(&command.twist);
        let disturbance = found.observer.estimate;
        let load = found.observer.load();
        let rate = load.compensated(&command.rate);
        let wrench = wrench(motion, &rate, &velocity_error, &disturbance);
        // What is not finite stays so in every sum: the disturbance in the wrench.
        if found.remembered + found.residue() + residue([wrench.force, wrench.moment]) != T::ZERO {
            return Err(StepFault::Overflow);
        }
        let (applied, saturated) = share(
            &motion.wheels,
            &wrench,
            limits.wheel_torque_nm,
            limits.policy,
        );
        // Those that were compared with the limit.
        let mut torques = motion.wheels.torques(&wrench);
        let mut driven = command.twist;
        if saturated {
            // A finite wrench may ask large wheels for torques that are not: inf - inf leaves no factor to share by.
            if residue([applied.force, applied.moment]) != T::ZERO {
                return Err(StepFault::Overflow);
            }
            torques = bounded(&motion.wheels.torques(&applied), limits.wheel_torque_nm);
            driven = achieved(motion, &rate, twist, &applied, &disturbance);
        }
        self.declared = false;
        self.stall = found.stall;
        self.observer = *found.observer;
        self.offset = found.offset;
        self.command = Command {
            twist: driven,
            ..command
        };
        let stands = || stands(motion, &self.command.twist, &velocity_error, &wrench, dt);
        self.released = found.resting && motion.releases() && (found.released || stands());
        self.exerted = (!self.released).then_some(applied);
        let parking = matches!(found.task, Task::Park(_)).then_some(&self.parking);
        *report = MotionReport {
            mode: found.task.mode(),
            outcome: match parking {
                Some(parking) if parking.is_parked() => Outcome::Parked,
                Some(parking) if parking.has_given_up() => Outcome::OutOfTolerance,
                _ if self.stall.is_stalled(motion) => Outcome::Stalled,
                _ => Outcome::Driving,
            },
            error: found.error,
            desired: found.setpoint.twist,
            desired_rate: found.setpoint.rate,
            transition_offset: found.offset.twist(),
            command: command.twist,
            command_rate: command.rate,
            velocity_error,
            disturbance,
            load,
            wrench,
            torques: if self.released {
                WheelTorques::default()
            } else {
                torques
            },
            limited: Limited {
                torque: saturated,
                grip: parking.is_some_and(ParkingLaw::has_slid),
                ..found.limited
            },
            jumped: found.jumped,
            backing: parking.is_some_and(ParkingLaw::is_backing),
            retries: parking.map_or(0, ParkingLaw::retries),
        };
        Ok(())
    }
}

impl<T: Scalar> Found<'_, T> {
    /// Nothing is infinite or NaN: a wild input is refused, and does not stay.
    fn residue(&self) -> T {
        let Setpoint { twist, rate } = &self.setpoint;
        let PoseError { x, y, theta } = self.error;
        let error = residue([x, y, theta]);
        self.offset.residue()
            + error
            + residue([twist.linear, twist.angular, rate.linear, rate.angular])
    }
}

impl<T: Scalar> ValidMotionParams<T> {
    /// Once parked the wheels exert nothing.
    fn releases(&self) -> bool {
        self.params().arrival.at_rest == AtRest::Release
    }
}

/// Goal and speed are below [`REACH`], and the observer remembers nothing that is no number: then its residue, `observed`, is 0.
pub(super) fn is_within_reach<T: Scalar>(
    error: &PoseError<T>,
    twist: &Twist<T>,
    observed: T,
) -> bool {
    let PoseError { x, y, theta } = error;
    let away = x.abs() + y.abs() + theta.abs();
    away + twist.linear.abs() + twist.angular.abs() + observed < T::from_f64(REACH)
}

/// Clips the last bits that [`share`] may leave above the limit.
fn bounded<T: Scalar>(torques: &WheelTorques<T>, limit: T) -> WheelTorques<T> {
    WheelTorques {
        right: clamp(torques.right, limit),
        left: clamp(torques.left, limit),
    }
}
