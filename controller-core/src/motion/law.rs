//! One tick from pose to wheel torques. Parameters and report are lent: they exist once, wherever the law is built in.

use super::arrival::AtRest;
use super::disturbance::{Observer, Watch};
use super::error_view::ErrorView;
use super::goal_checker::{Pushing, STOPPING_DECAY, Stall};
use super::governor::Command;
use super::params::ValidMotionParams;
use super::pose_law::{Approach, Before as PoseLawBefore, Moving, PoseLaw, Step, Transition};
use super::report::{Limited, Mode, MotionReport, Outcome};
use super::saturation::share;
use super::setpoint::Setpoint;
use super::task::{Aim, Task};
use super::transition_offset::TransitionOffset;
use super::velocity_loop::{achieved, stands, wrench};
use crate::check::{check_measured, check_tick, residue};
use crate::error::{Input, StepFault};
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Measured, Twist, WheelTorques};
use core::marker::PhantomData;

/// What the law remembers from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotionLaw<T, M, U> {
    aim: Aim<T>,
    pose_law: PoseLaw<T>,
    stall: Stall<T>,
    observer: Observer<T>,
    offset: TransitionOffset<T>,
    command: Command<T>,
    /// The caller said that the pose will jump.
    declared: bool,
    /// Parked without torque: the command is what the robot does by itself.
    released: bool,
    approach: Approach<T>,
    back_ends: PhantomData<(M, U)>,
}

/// What a tick may change, as it was before: a tick that is refused changes nothing. In pieces, which are copied in
/// a few instructions each.
struct Before<T> {
    aim: Aim<T>,
    pose_law: PoseLawBefore<T>,
    stall: Stall<T>,
    observer: Observer<T>,
    offset: TransitionOffset<T>,
    command: Command<T>,
    flags: (bool, bool),
    approach: Approach<T>,
}

/// What a tick found on its way to the torque, for its report.
struct Found<T> {
    error: PoseError<T>,
    setpoint: Setpoint<T>,
    limited: Limited,
    jumped: bool,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> MotionLaw<T, M, U> {
    /// Nothing seen, nothing asked for.
    pub(crate) const IDLE: Self = Self {
        aim: Aim::Follow,
        pose_law: PoseLaw::NEW,
        stall: Stall::NEW,
        observer: Observer::NEW,
        offset: TransitionOffset::NONE,
        command: Command::REST,
        declared: false,
        released: false,
        approach: Approach::Idle,
        back_ends: PhantomData,
    };

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
        check_measured(measured)?;
        task.check()?;
        *self = Self::IDLE;
        self.aim = task.aim();
        self.observer = Observer::start(&measured.twist);
        self.command = Command::of_robot(motion, &measured.twist);
        let view = ErrorView::of::<M>(task, &measured.pose, T::ZERO);
        let moving = Moving {
            heading: measured.pose.theta,
            twist: &measured.twist,
            command: &self.command,
        };
        let step = Step {
            dt: T::ZERO,
            two_per_dt: None,
        };
        let desired =
            self.pose_law
                .advance::<U, M>(&mut self.approach, motion, task, &view, moving, step);
        self.offset = TransitionOffset::between(&self.command, &desired.setpoint, T::ONE, T::ZERO);
        let found = Found {
            error: view.error,
            setpoint: desired.setpoint,
            limited: Limited::default(),
            jumped: true,
        };
        self.finish(motion, &found, &measured.twist, T::ZERO, report)
    }

    /// One tick, `dt` \[s\] after the last, whose `report` becomes that of this one.
    ///
    /// # Errors
    /// Any [`StepFault`]; law and report are then unchanged, and the wheels are the caller's to make safe.
    pub(crate) fn step(
        &mut self,
        motion: &ValidMotionParams<T>,
        dt: T,
        task: &Task<T>,
        measured: &Measured<T>,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        check_tick(dt, motion.params().max_tick_s)?;
        check_measured(measured)?;
        task.check()?;
        let before = self.before();
        if self.released {
            self.command = Command::of_robot(motion, &measured.twist);
        }
        let watch = if self.pose_law.is_resting() && motion.releases() {
            Watch::Fade
        } else {
            Watch::Observe
        };
        let bounded = self
            .observer
            .advance(motion, &measured.twist, &self.command.rate, watch, dt);
        let drive = &mut self.pose_law.drive;
        drive.turn_on(&self.command, dt);
        let turned = drive.error(measured.pose.theta);
        let view = ErrorView::of::<M>(task, &measured.pose, turned);
        let aim = task.aim();
        let new = aim != self.aim;
        if new {
            self.pose_law.renew_retries(&mut self.approach);
        }
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
        let moving = Moving {
            heading: measured.pose.theta,
            twist: &measured.twist,
            command: &self.command,
        };
        let desired =
            self.pose_law
                .advance::<U, M>(&mut self.approach, motion, task, &view, moving, step);
        let resting = self.pose_law.is_resting();
        self.offset = match desired.transition {
            Transition::Seamless => TransitionOffset::NONE,
            Transition::Offset => {
                let kept = Self::kept(motion, jumped && report.jumped, dt);
                TransitionOffset::between(&self.command, &desired.setpoint, kept, dt)
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
        self.released &= resting;
        let mut limited = if self.released {
            Limited::default()
        } else {
            let setpoint = self.offset.added_to(&desired.setpoint);
            let (command, limited) = self.command.advance(motion, &setpoint, dt);
            self.command = command;
            limited
        };
        limited.disturbance = bounded;
        limited.speed |= task.is_beyond(motion);
        self.aim = aim;
        self.declared = false;
        let pushing = Pushing {
            command: self.command.twist,
            twist: measured.twist,
            saturated: report.limited.torque,
        };
        self.stall = self.stall.advance(motion, &pushing, dt);
        let found = Found {
            error: view.error,
            setpoint: desired.setpoint,
            limited,
            jumped,
        };
        let finished = self.finish(motion, &found, &measured.twist, dt, report);
        if finished.is_err() {
            self.restore(before);
        }
        finished
    }

    /// The next pose jumps; see [`MotionController::declare_jump`](super::MotionController::declare_jump).
    pub(crate) const fn declare_jump(&mut self) {
        self.declared = true;
    }

    /// What the wheels really exert until the next tick; see
    /// [`MotionController::note_applied`](super::MotionController::note_applied).
    ///
    /// # Errors
    /// A torque that is not finite; nothing is noted then.
    pub(crate) fn note_applied(
        &mut self,
        motion: &ValidMotionParams<T>,
        applied: &WheelTorques<T>,
    ) -> Result<(), StepFault> {
        if !(applied.right.is_finite() && applied.left.is_finite()) {
            return Err(StepFault::NotFinite(Input::Applied));
        }
        self.observer.note(Some(motion.wheels.wrench(applied)));
        Ok(())
    }

    /// Until the next tick the wheels are not driven.
    pub(crate) fn note_not_driven(&mut self) {
        self.observer.note(None);
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

    fn before(&self) -> Before<T> {
        Before {
            aim: self.aim,
            pose_law: self.pose_law.before(),
            stall: self.stall,
            observer: self.observer,
            offset: self.offset,
            command: self.command,
            flags: (self.declared, self.released),
            approach: self.approach.kept(),
        }
    }

    #[cold]
    fn restore(&mut self, before: Before<T>) {
        self.aim = before.aim;
        self.pose_law.restore(before.pose_law);
        self.stall = before.stall;
        self.observer = before.observer;
        self.offset = before.offset;
        self.command = before.command;
        (self.declared, self.released) = before.flags;
        self.approach = before.approach;
    }

    /// The end of a tick: torque for the command with the measured `twist`, the wheels' limit and what it does to the
    /// command, the report.
    fn finish(
        &mut self,
        motion: &ValidMotionParams<T>,
        found: &Found<T>,
        twist: &Twist<T>,
        dt: T,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        let limits = &motion.params().limits;
        let command = self.command;
        let velocity_error = twist.minus(&command.twist);
        let disturbance = self.observer.estimate;
        let wrench = wrench(motion, &command.rate, &velocity_error, &disturbance);
        let own = found.residue() + self.residue();
        if own + residue([wrench.force, wrench.moment]) != T::ZERO {
            return Err(StepFault::Overflow);
        }
        let (applied, saturated) = share(
            &motion.wheels,
            &wrench,
            limits.wheel_torque_nm,
            limits.policy,
        );
        if saturated {
            self.command.twist = achieved(motion, &command, twist, &applied, &disturbance);
        }
        self.released = self.pose_law.is_resting()
            && motion.releases()
            && (self.released || stands(motion, &self.command.twist, &velocity_error, &wrench, dt));
        self.observer.note((!self.released).then_some(applied));
        *report = MotionReport {
            mode: match self.aim {
                Aim::Follow => Mode::Following,
                Aim::Park(_) => Mode::Parking,
                Aim::Drive => Mode::Driving,
            },
            outcome: self.outcome(motion),
            error: found.error,
            desired: found.setpoint.twist,
            desired_rate: found.setpoint.rate,
            transition_offset: self.offset.twist(),
            command: command.twist,
            command_rate: command.rate,
            velocity_error,
            disturbance,
            wrench,
            torques: if self.released {
                WheelTorques::default()
            } else {
                bounded(&motion.wheels.torques(&applied), limits.wheel_torque_nm)
            },
            limited: Limited {
                torque: saturated,
                ..found.limited
            },
            jumped: found.jumped,
            backing: self.pose_law.is_backing(&self.approach),
            retries: self.pose_law.retries(),
        };
        Ok(())
    }

    fn outcome(&self, motion: &ValidMotionParams<T>) -> Outcome {
        if self.pose_law.is_parked() {
            Outcome::Parked
        } else if self.pose_law.has_given_up() {
            Outcome::OutOfTolerance
        } else if self.stall.is_stalled(motion) {
            Outcome::Stalled
        } else {
            Outcome::Driving
        }
    }

    /// No memory is infinite or NaN: a wild input is refused, and does not stay.
    fn residue(&self) -> T {
        let laws = self.pose_law.residue(&self.aim) + self.approach.residue();
        self.observer.residue() + self.offset.residue() + laws
    }
}

impl<T: Scalar> Found<T> {
    fn residue(&self) -> T {
        let Setpoint { twist, rate } = &self.setpoint;
        let PoseError { x, y, theta } = self.error;
        let error = residue([x, y, theta]);
        error + residue([twist.linear, twist.angular, rate.linear, rate.angular])
    }
}

impl<T: Scalar> ValidMotionParams<T> {
    /// Once parked the wheels exert nothing.
    fn releases(&self) -> bool {
        self.params().arrival.at_rest == AtRest::Release
    }
}

/// Clips the last bits that [`share`] may leave above the limit.
fn bounded<T: Scalar>(torques: &WheelTorques<T>, limit: T) -> WheelTorques<T> {
    WheelTorques {
        right: clamp(torques.right, limit),
        left: clamp(torques.left, limit),
    }
}
