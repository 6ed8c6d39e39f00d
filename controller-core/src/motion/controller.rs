//! The controller for a real base: one tick from pose to wheel torques.

use super::arrival::AtRest;
use super::disturbance::{Observer, Watch};
use super::error_view::ErrorView;
use super::goal_checker::{Pushing, STOPPING_DECAY, Stall};
use super::governor::Command;
use super::params::ValidMotionParams;
use super::pose_law::{Approach, Moving, PoseLaw, Step, Transition};
use super::report::{Limited, Mode, MotionReport, Outcome};
use super::saturation::share;
use super::setpoint::Setpoint;
use super::task::Task;
use super::transition_offset::TransitionOffset;
use super::velocity_loop::{achieved, stands, wrench};
use crate::check::{check_measured, check_tick};
use crate::error::{Input, StepFault};
use crate::maths::{Maths, Single};
use crate::pose_error::PoseError;
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::shunting::{NeuronUpdate, RationalMean};
use crate::types::{Measured, Twist, WheelTorques};
use core::marker::PhantomData;

/// What changes from tick to tick; copied first and stored last, so that a fault changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State<T> {
    task: Task<T>,
    pose_law: PoseLaw<T>,
    stall: Stall<T>,
    observer: Observer<T>,
    offset: TransitionOffset<T>,
    command: Command<T>,
    /// The caller said that the pose will jump.
    declared: bool,
    /// Parked without torque: the command is what the robot does by itself.
    released: bool,
}

/// What a tick found on its way to the torque, for its report.
struct Found<T> {
    error: PoseError<T>,
    setpoint: Setpoint<T>,
    limited: Limited,
    jumped: bool,
}

/// Follows any trajectory, parks exactly, drives by velocity, within the limits of the base. See [`crate::motion`].
///
/// ```
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, MotionController, MotionParams, SaturationPolicy, Task};
/// use controller_core::robot::Robot;
/// use controller_core::types::{Measured, Pose};
///
/// let limits = Limits {
///     speed: 1.0, turn_rate: 2.0, accel: 0.8, brake: 1.0, turn_accel: 3.0,
///     jerk: 20.0, turn_jerk: 40.0, wheel_torque_nm: 8.0, policy: SaturationPolicy::KeepCurvature,
/// };
/// let motion = MotionParams::new(Robot::paper(), limits).validate()?;
/// let here = Measured::default();
/// let task = Task::Park(Pose::new(1.0_f32, 0.5, 0.0));
/// let mut controller: MotionController = MotionController::start(&motion, &task, &here)?;
/// assert_eq!(controller.report().torques.right, 0.0);
/// let report = controller.step(0.01, &task, &here)?;
/// assert!(report.torques.right.abs() <= 8.0);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionController<T = f32, M = Single, U = RationalMean> {
    motion: ValidMotionParams<T>,
    state: State<T>,
    approach: Approach<T>,
    report: MotionReport<T>,
    back_ends: PhantomData<(M, U)>,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> MotionController<T, M, U> {
    /// Starts from any pose and twist: the first command is the measured twist, the first torque 0
    /// (from a twist beyond the limits: the command is the limit, and the torque brakes).
    ///
    /// # Errors
    /// An input that is not finite, or so large that a torque is not.
    pub fn start(
        motion: &ValidMotionParams<T>,
        task: &Task<T>,
        measured: &Measured<T>,
    ) -> Result<Self, StepFault> {
        check_measured(measured)?;
        task.check()?;
        let command = Command::of_robot(motion, &measured.twist);
        let view = ErrorView::of::<M>(task, &measured.pose, T::ZERO);
        let mut pose_law = PoseLaw::default();
        let moving = Moving {
            heading: measured.pose.theta,
            twist: &measured.twist,
            command: &command,
        };
        let step = Step {
            dt: T::ZERO,
            two_per_dt: None,
        };
        let mut approach = Approach::default();
        let desired = pose_law.advance::<U, M>(&mut approach, motion, task, &view, moving, step);
        let state = State {
            task: *task,
            pose_law,
            stall: Stall::default(),
            observer: Observer::start(&measured.twist),
            offset: TransitionOffset::between(&command, &desired.setpoint, T::ONE, T::ZERO),
            command,
            declared: false,
            released: false,
        };
        let mut controller = Self {
            motion: *motion,
            state,
            approach,
            report: MotionReport::default(),
            back_ends: PhantomData,
        };
        let found = Found {
            error: view.error,
            setpoint: desired.setpoint,
            limited: Limited::default(),
            jumped: true,
        };
        controller.finish(state, &found, &measured.twist, T::ZERO)?;
        Ok(controller)
    }

    /// One tick, `dt` \[s\] after the last.
    ///
    /// # Errors
    /// Any [`StepFault`]; the state is then unchanged, and the wheels are the caller's to make safe.
    pub fn step(
        &mut self,
        dt: T,
        task: &Task<T>,
        measured: &Measured<T>,
    ) -> Result<&MotionReport<T>, StepFault> {
        check_tick(dt, self.motion.params().max_tick_s)?;
        check_measured(measured)?;
        task.check()?;
        let motion = &self.motion;
        let mut state = self.state;
        if state.released {
            state.command = Command::of_robot(motion, &measured.twist);
        }
        let watch = if state.pose_law.is_resting() && motion.releases() {
            Watch::Fade
        } else {
            Watch::Observe
        };
        let bounded =
            state
                .observer
                .advance(motion, &measured.twist, &state.command.rate, watch, dt);
        let drive = &mut state.pose_law.drive;
        drive.turn_on(&state.command, dt);
        let turned = drive.error(measured.pose.theta);
        let view = ErrorView::of::<M>(task, &measured.pose, turned);
        let new = task.is_new(&state.task);
        let before = self.approach.kept();
        if new {
            state.pose_law.renew_retries(&mut self.approach);
        }
        let jumped =
            new || state.declared || view.has_jumped::<M>(&self.report.error, motion.params(), dt);
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
            command: &state.command,
        };
        let desired =
            state
                .pose_law
                .advance::<U, M>(&mut self.approach, motion, task, &view, moving, step);
        let resting = state.pose_law.is_resting();
        state.offset = match desired.transition {
            Transition::Seamless => TransitionOffset::default(),
            Transition::Offset => {
                let kept = self.kept(jumped, dt);
                TransitionOffset::between(&state.command, &desired.setpoint, kept, dt)
            }
            Transition::Continue => {
                let decay = if resting {
                    T::from_f64(STOPPING_DECAY)
                } else {
                    motion.gains().decay
                };
                let fade = T::ONE + M::exp_m1(-(decay * dt));
                state.offset.advance(decay, dt, fade)
            }
        };
        state.released &= resting;
        let mut limited = if state.released {
            Limited::default()
        } else {
            let setpoint = state.offset.added_to(&desired.setpoint);
            let (command, limited) = state.command.advance(motion, &setpoint, dt);
            state.command = command;
            limited
        };
        limited.disturbance = bounded;
        limited.speed |= task.is_beyond(motion);
        state.task = *task;
        state.declared = false;
        let pushing = Pushing {
            command: state.command.twist,
            twist: measured.twist,
            saturated: self.report.limited.torque,
        };
        state.stall = state.stall.advance(motion, &pushing, dt);
        let found = Found {
            error: view.error,
            setpoint: desired.setpoint,
            limited,
            jumped,
        };
        if let Err(fault) = self.finish(state, &found, &measured.twist, dt) {
            self.approach = before;
            return Err(fault);
        }
        Ok(&self.report)
    }

    /// The next pose jumps: the localisation was corrected, or the reference replaced. Command and
    /// torque go on as they are, and the difference fades.
    pub fn declare_jump(&mut self) {
        self.state.declared = true;
    }

    /// What the wheels really exert from now on until the next tick, if it is not what the last report
    /// asks for: a motor layer or a supervisor limited it. The disturbance estimate needs it.
    ///
    /// # Errors
    /// A torque that is not finite; nothing is noted then.
    pub fn note_applied(&mut self, applied: &WheelTorques<T>) -> Result<(), StepFault> {
        if !(applied.right.is_finite() && applied.left.is_finite()) {
            return Err(StepFault::NotFinite(Input::Applied));
        }
        let exerted = self.motion.wheels.wrench(applied);
        self.state.observer.note(Some(exerted));
        Ok(())
    }

    /// Until the next tick the wheels are not driven, or nobody knows with what torque (a brake, a
    /// fault): the disturbance estimate rests over that tick.
    pub fn note_not_driven(&mut self) {
        self.state.observer.note(None);
    }

    /// The report of the last tick.
    pub fn report(&self) -> &MotionReport<T> {
        &self.report
    }

    /// The parameters in use.
    pub fn motion(&self) -> &ValidMotionParams<T> {
        &self.motion
    }

    /// How much of its rate the command keeps in a tick that jumps: all of it, unless the last tick
    /// jumped too. A goal that moves at every tick must not keep the robot from answering.
    fn kept(&self, jumped: bool, dt: T) -> T {
        if jumped && self.report.jumped {
            let decay = self.motion.gains().decay;
            T::ONE + M::exp_m1(-((decay + decay) * dt))
        } else {
            T::ONE
        }
    }

    /// The end of a tick: torque for the command in `state` with the measured `twist`, the wheels' limit and
    /// what it does to the command, the report.
    fn finish(
        &mut self,
        mut state: State<T>,
        found: &Found<T>,
        twist: &Twist<T>,
        dt: T,
    ) -> Result<(), StepFault> {
        let motion = &self.motion;
        let limits = &motion.params().limits;
        let command = state.command;
        let velocity_error = twist.minus(&command.twist);
        let disturbance = state.observer.estimate;
        let wrench = wrench(motion, &command.rate, &velocity_error, &disturbance);
        let finite = wrench.force.is_finite() && wrench.moment.is_finite();
        if !(finite && found.is_finite() && state.is_finite() && self.approach.is_finite()) {
            return Err(StepFault::Overflow);
        }
        let (applied, saturated) = share(
            &motion.wheels,
            &wrench,
            limits.wheel_torque_nm,
            limits.policy,
        );
        if saturated {
            state.command.twist = achieved(motion, &command, twist, &applied, &disturbance);
        }
        state.released = state.pose_law.is_resting()
            && motion.releases()
            && (state.released
                || stands(motion, &state.command.twist, &velocity_error, &wrench, dt));
        state.observer.note((!state.released).then_some(applied));
        let torques = if state.released {
            WheelTorques::default()
        } else {
            bounded(&motion.wheels.torques(&applied), limits.wheel_torque_nm)
        };
        self.report = MotionReport {
            mode: match state.task {
                Task::Follow(_) => Mode::Following,
                Task::Park(_) => Mode::Parking,
                Task::Drive { .. } => Mode::Driving,
            },
            outcome: state.outcome(motion),
            error: found.error,
            desired: found.setpoint.twist,
            desired_rate: found.setpoint.rate,
            transition_offset: state.offset.twist(),
            command: command.twist,
            command_rate: command.rate,
            velocity_error,
            disturbance,
            wrench,
            torques,
            limited: Limited {
                torque: saturated,
                ..found.limited
            },
            jumped: found.jumped,
            backing: state.pose_law.is_backing(&self.approach),
            retries: state.pose_law.retries(),
        };
        self.state = state;
        Ok(())
    }
}

impl<T: Scalar> State<T> {
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
    fn is_finite(&self) -> bool {
        self.observer.is_finite() && self.pose_law.is_finite() && self.offset.is_finite()
    }
}

impl<T: Scalar> Found<T> {
    fn is_finite(&self) -> bool {
        let Setpoint { twist, rate } = &self.setpoint;
        let error = &self.error;
        let error = error.x.is_finite() && error.y.is_finite() && error.theta.is_finite();
        error && twist.is_finite() && rate.is_finite()
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
