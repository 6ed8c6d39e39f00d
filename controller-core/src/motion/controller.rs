//! The controller for a real base: the motion law with its parameters and its report.

use super::law::{MotionLaw, is_within_reach};
use super::params::ValidMotionParams;
use super::report::MotionReport;
use super::task::{Asked, Task};
use crate::check::check_measured;
use crate::error::StepFault;
use crate::maths::{Maths, Single};
use crate::pose_error::PoseError;
use crate::scalar::Scalar;
use crate::shunting::{NeuronUpdate, RationalMean};
use crate::types::{Measured, Pose, WheelTorques};

/// Follows any trajectory, parks exactly, drives by velocity, within the limits of the base. See [`crate::motion`].
///
/// ```
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, MotionController, MotionParams, SaturationPolicy, Task};
/// use controller_core::robot::Robot;
/// use controller_core::types::{Measured, Pose};
///
/// let limits = Limits {
///     speed: 1.0, turn_rate: 2.0, rim_speed: 1.2, accel: 0.8, brake: 1.0, turn_accel: 3.0,
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
    law: MotionLaw<T, M, U>,
    /// Of the last tick that parked.
    goal: Pose<T>,
    report: MotionReport<T>,
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
        let mut controller = Self {
            motion: *motion,
            law: MotionLaw::IDLE,
            goal: match task {
                Task::Park(goal) => *goal,
                Task::Follow(_) | Task::Drive { .. } => Pose::default(),
            },
            report: MotionReport::default(),
        };
        let Self { law, report, .. } = &mut controller;
        law.begin(motion, task, measured, report)?;
        Ok(controller)
    }

    /// One tick, `dt` \[s\] after the last.
    ///
    /// # Errors
    /// Any [`StepFault`]; the state is then unchanged, and the wheels are the caller's to make safe. Parking
    /// refuses a goal 10⁹ m away, and it and driving by velocity such a speed, as an overflow.
    pub fn step(
        &mut self,
        dt: T,
        task: &Task<T>,
        measured: &Measured<T>,
    ) -> Result<&MotionReport<T>, StepFault> {
        let Self {
            motion,
            law,
            goal: last,
            report,
        } = self;
        // What is measured goes into the errors of a reference and of a goal, all of it: there it is looked at once a tick is refused.
        let other_goal = match task {
            Task::Follow(_) => false,
            Task::Park(goal) => goal != last,
            Task::Drive { .. } => {
                check_measured(measured)?;
                // No odometry stands before it, as before that of a base.
                if !is_within_reach(&PoseError::default(), &measured.twist, T::ZERO) {
                    return Err(StepFault::Overflow);
                }
                false
            }
        };
        match law.step(motion, dt, Asked { task, other_goal }, measured, report) {
            Ok(()) => {
                if let (true, Task::Park(goal)) = (other_goal, task) {
                    *last = *goal;
                }
                Ok(report)
            }
            Err(fault) => {
                check_measured(measured)?;
                Err(fault)
            }
        }
    }

    /// The next pose jumps: the localisation was corrected, or the reference replaced. Command and
    /// torque go on as they are, and the difference fades.
    pub const fn declare_jump(&mut self) {
        self.law.declare_jump();
    }

    /// Wheels slide over the floor, as who compares them with a gyro knows: to be said at every tick while they do. A manoeuvre under way is
    /// planned anew with half the accelerations, once for each goal ([`Limited::grip`](super::Limited::grip)), without a step of command or torque.
    /// Nothing else of the law yields: it does not choose what a reference or an order asks for.
    pub fn declare_slide(&mut self) {
        self.law.declare_slide();
    }

    /// What the wheels really exert from now on until the next tick, if it is not what the last report
    /// asks for: a motor layer or a supervisor limited it. The disturbance estimate needs it.
    ///
    /// # Errors
    /// A torque that is not finite, or above ten times [`Limits::wheel_torque_nm`](super::Limits); nothing is noted then.
    pub fn note_applied(&mut self, applied: &WheelTorques<T>) -> Result<(), StepFault> {
        self.law
            .note_applied(&self.motion, applied, &mut self.report)
    }

    /// Until the next tick the wheels are not driven, or nobody knows with what torque (a brake, a
    /// fault): the disturbance estimate rests over that tick.
    pub fn note_not_driven(&mut self) {
        self.law.note_not_driven();
    }

    /// The report of the last tick.
    pub const fn report(&self) -> &MotionReport<T> {
        &self.report
    }

    /// The parameters in use.
    pub const fn motion(&self) -> &ValidMotionParams<T> {
        &self.motion
    }
}
