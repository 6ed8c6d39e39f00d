//! The controller for a real base: one tick from pose to wheel torques.

use super::arrival::AtRest;
use super::bridge::Bridge;
use super::disturbance::{Observer, Watch};
use super::follow::{Follower, Instant, Wish};
use super::goal_checker::{Latch, Pushing, STOPPING_DECAY, Stall, Standing};
use super::governor::Command;
use super::params::Motion;
use super::polar::Parker;
use super::report::{Limited, Mode, MotionReport, Outcome};
use super::retry::{Rest, Retry, distance_of};
use super::saturation::share;
use crate::check::{check_measured, check_tick};
use crate::error::{Input, StepFault};
use crate::maths::{Maths, Single};
use crate::pose_error::{PoseError, pose_error, tracking_error};
use crate::range::clamp;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::{NeuronUpdate, RationalMean};
use crate::types::{Accel, Measured, Pose, Twist, WheelTorques, Wrench};
use core::marker::PhantomData;

mod output;
mod pose_law;
mod state;

use state::{Law, Sight, State};

/// What the robot is to do in a tick. May change at any time; command and torque do not jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task<T = f32> {
    /// Follow this sample of a reference: its pose and twist are those of the present instant.
    /// Sample its acceleration half a tick ahead if you can, since it will be held for a tick: at
    /// 10 ms that is 1.4 to 2 times less error.
    Follow(Reference<T>),
    /// Go to this pose and stay.
    Park(Pose<T>),
}

/// Follows any trajectory and parks exactly, within the limits of the base. See [`crate::motion`].
///
/// ```
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, MotionController, MotionParams, Policy, Task};
/// use controller_core::robot::Robot;
/// use controller_core::types::{Measured, Pose};
///
/// let limits = Limits {
///     speed: 1.0, turn_rate: 2.0, accel: 0.8, brake: 1.0, turn_accel: 3.0,
///     jerk: 20.0, turn_jerk: 40.0, wheel_torque_nm: 8.0, policy: Policy::KeepCurvature,
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
    motion: Motion<T>,
    state: State<T>,
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
        motion: &Motion<T>,
        task: &Task<T>,
        measured: &Measured<T>,
    ) -> Result<Self, StepFault> {
        check(task, measured)?;
        let command = Command::of_robot(motion, &measured.twist);
        let mut controller = Self {
            motion: *motion,
            state: State {
                task: *task,
                follower: Follower::default(),
                parker: Parker::default(),
                latch: Latch::default(),
                stall: Stall::default(),
                retry: Retry::default(),
                observer: Observer::start(&measured.twist),
                bridges: Default::default(),
                command,
                declared: false,
                released: false,
            },
            report: MotionReport::default(),
            back_ends: PhantomData,
        };
        let mut state = controller.state;
        let seen = Sight::of::<M>(task, measured);
        let law = controller.law(&mut state, T::ZERO, None, (task, &seen), measured);
        state.bridges = bridges(&command, &law.wish, T::ONE, T::ZERO);
        controller.finish(state, &law, Default::default(), true, measured, T::ZERO)?;
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
        check(task, measured)?;
        let mut state = self.state;
        if state.released {
            state.command = Command::of_robot(&self.motion, &measured.twist);
        }
        let watch = if self.is_letting_go() {
            Watch::Fade
        } else {
            Watch::Observe
        };
        let motion = &self.motion;
        let bounded =
            state
                .observer
                .advance(motion, &measured.twist, &state.command.rate, watch, dt);
        let seen = Sight::of::<M>(task, measured);
        if self.is_new(task) {
            state.retry = Retry::default();
        }
        let jumped = self.is_jump(dt, task, &seen);
        let two_per_dt = (T::ONE + T::ONE) / dt;
        let advance = if jumped { None } else { Some(two_per_dt) };
        let law = self.law(&mut state, dt, advance, (task, &seen), measured);
        if jumped || law.rebase {
            let kept = self.kept(jumped, dt);
            state.bridges = bridges(&state.command, &law.wish, kept, dt);
        } else {
            state.bridges = self.faded(&state, dt);
        }
        state.released &= state.is_resting();
        let mut limited = if state.released {
            Limited::default()
        } else {
            let wish = bridged(&law.wish, &state.bridges);
            let (command, limited) = state.command.advance(&self.motion, &wish, dt);
            state.command = command;
            limited
        };
        limited.disturbance = bounded;
        state.task = *task;
        state.declared = false;
        let pushing = Pushing {
            command: state.command.twist,
            twist: measured.twist,
            saturated: self.report.limited.torque,
        };
        state.stall = state.stall.advance(&self.motion, &pushing, dt);
        self.finish(state, &law, limited, jumped, measured, dt)
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
    pub fn motion(&self) -> &Motion<T> {
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

    fn faded(&self, state: &State<T>, dt: T) -> (Bridge<T>, Bridge<T>) {
        let decay = if state.is_resting() {
            T::from_f64(STOPPING_DECAY)
        } else {
            self.motion.gains().decay
        };
        let fade = T::ONE + M::exp_m1(-(decay * dt));
        let (linear, angular) = &state.bridges;
        (
            linear.advance(decay, dt, fade),
            angular.advance(decay, dt, fade),
        )
    }
}

fn check<T: Scalar>(task: &Task<T>, measured: &Measured<T>) -> Result<(), StepFault> {
    check_measured(measured)?;
    match task {
        Task::Follow(reference) if !reference.is_finite() => {
            Err(StepFault::NotFinite(Input::Reference))
        }
        Task::Park(goal) if !goal.is_finite() => Err(StepFault::NotFinite(Input::Goal)),
        _ => Ok(()),
    }
}

/// Bridges with which the wish, from now on, goes on from where a command would be by now, in value
/// and, as far as it is `kept`, in rate.
fn bridges<T: Scalar>(
    command: &Command<T>,
    wish: &Wish<T>,
    kept: T,
    dt: T,
) -> (Bridge<T>, Bridge<T>) {
    let bridge = |speed: T, accel: T, wish: T, wish_rate: T| {
        let rate = kept * (accel - wish_rate);
        Bridge {
            value: speed + dt * (wish_rate + rate) - wish,
            rate,
        }
    };
    let (twist, rate) = (&command.twist, &command.rate);
    let (to, to_rate) = (&wish.twist, &wish.rate);
    (
        bridge(twist.linear, rate.linear, to.linear, to_rate.linear),
        bridge(twist.angular, rate.angular, to.angular, to_rate.angular),
    )
}

fn bridged<T: Scalar>(wish: &Wish<T>, (linear, angular): &(Bridge<T>, Bridge<T>)) -> Wish<T> {
    Wish {
        twist: Twist {
            linear: wish.twist.linear + linear.value,
            angular: wish.twist.angular + angular.value,
        },
        rate: Accel {
            linear: wish.rate.linear + linear.rate,
            angular: wish.rate.angular + angular.rate,
        },
    }
}
