//! From the supervisor's output to what the wheels are to do: the motion law, the stop plan, or neither.

use super::io::{DriveCommand, WheelAction};
use super::locate::Located;
use super::wheel_friction::{FrictionWatch, Turning};
use crate::error::StepFault;
use crate::maths::Maths;
use crate::motion::{MotionController, MotionReport, Outcome, Task, ValidMotionParams};
use crate::safety::{OutputMode, StopPlan};
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Measured, Twist, WheelSpeeds, WheelTorques};

/// What is driven, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Driving<T, M, U> {
    /// What the orders amount to.
    pub(super) task: Option<Task<T>>,
    /// While its torque flows.
    motion: Option<MotionController<T, M, U>>,
    /// Of a controlled stop, and the time since its begin \[s\].
    stop: Option<(StopPlan<T>, T)>,
    /// While driving by velocity.
    friction: Option<FrictionWatch<T>>,
}

/// What came of a tick.
pub(super) struct Driven<T> {
    pub(super) action: WheelAction<T>,
    /// Whether the base stands at its goal, if it was on its way to one.
    pub(super) at_goal: Option<bool>,
}

impl<T> Driven<T> {
    const fn only(action: WheelAction<T>) -> Self {
        Self {
            action,
            at_goal: None,
        }
    }
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> Driving<T, M, U> {
    /// Nothing to do, and no torque.
    pub(super) const IDLE: Self = Self {
        task: None,
        motion: None,
        stop: None,
        friction: None,
    };

    /// What the wheels are to do in `mode`. `speeds` are those of the wheels, as measured.
    ///
    /// # Errors
    /// A step that the motion law refuses.
    pub(super) fn act(
        &mut self,
        motion: &ValidMotionParams<T>,
        mode: OutputMode,
        located: &Located<T>,
        speeds: WheelSpeeds<T>,
        turning: Option<Turning<'_, T>>,
        dt: T,
    ) -> Result<Driven<T>, StepFault> {
        let beyond = self.beyond_coulomb(turning);
        if mode != OutputMode::ControlledStop {
            self.stop = None;
        }
        let jumped = located.jumped;
        match mode {
            OutputMode::Drive | OutputMode::Hold => match (self.task, &located.measured) {
                (Some(task), Some(measured)) => {
                    let report = *self.step(motion, &task, measured, jumped, dt)?;
                    let at_goal = report.outcome == Outcome::Parked;
                    Ok(Driven {
                        action: drive(motion, &report, speeds, beyond),
                        at_goal: matches!(task, Task::Park(_)).then_some(at_goal),
                    })
                }
                // Armed before the first reading: nothing to go by yet, so nothing is exerted.
                _ => Ok(self.without_torque()),
            },
            OutputMode::ControlledStop => match &located.measured {
                Some(measured) => {
                    let report = *self.brake_along_plan(motion, measured, jumped, dt)?;
                    Ok(Driven::only(drive(motion, &report, speeds, beyond)))
                }
                None => Ok(self.without_torque()),
            },
            OutputMode::ZeroTorque => Ok(self.without_torque()),
            OutputMode::Brake => {
                self.let_go();
                Ok(Driven::only(WheelAction::Brake))
            }
            OutputMode::Release => {
                self.let_go();
                Ok(Driven::only(WheelAction::Release))
            }
        }
    }

    /// What the wheels' friction is found to be beyond its Coulomb part, while the base drives by velocity and has motors.
    fn beyond_coulomb(&mut self, turning: Option<Turning<'_, T>>) -> Option<WheelTorques<T>> {
        match (self.task, turning) {
            (Some(Task::Drive { .. }), Some(turning)) => {
                let watch = self.friction.get_or_insert_default();
                Some(watch.advance(&turning))
            }
            _ => {
                self.friction = None;
                None
            }
        }
    }

    /// The motion law's step, or its start.
    fn step(
        &mut self,
        motion: &ValidMotionParams<T>,
        task: &Task<T>,
        measured: &Measured<T>,
        jumped: bool,
        dt: T,
    ) -> Result<&MotionReport<T>, StepFault> {
        match self.motion {
            None => {
                let started = MotionController::start(motion, task, measured)?;
                Ok(self.motion.insert(started).report())
            }
            Some(ref mut controller) => {
                if jumped {
                    controller.declare_jump();
                }
                controller.step(dt, task, measured)
            }
        }
    }

    /// The controlled stop: the motion law along a plan that begins at its last command.
    fn brake_along_plan(
        &mut self,
        motion: &ValidMotionParams<T>,
        measured: &Measured<T>,
        jumped: bool,
        dt: T,
    ) -> Result<&MotionReport<T>, StepFault> {
        let (plan, t) = match self.stop {
            Some((plan, t)) => (plan, t + dt),
            None => {
                let command = match &self.motion {
                    Some(controller) => controller.report().command,
                    None => measured.twist,
                };
                (StopPlan::new::<M>(motion, &command), T::ZERO)
            }
        };
        let first = self.stop.is_none();
        self.stop = Some((plan, t));
        let task = plan.task::<M>(t, dt, &measured.pose);
        self.step(motion, &task, measured, jumped || first, dt)
    }

    /// Enabled, with no law at work.
    fn without_torque(&mut self) -> Driven<T> {
        self.motion = None;
        Driven::only(WheelAction::Drive(DriveCommand::default()))
    }

    fn let_go(&mut self) {
        self.motion = None;
        self.task = None;
    }

    /// The motion law's report, while its torque flows.
    pub(super) fn report(&self) -> Option<&MotionReport<T>> {
        self.motion.as_ref().map(MotionController::report)
    }

    /// The command in force; none is rest.
    pub(super) fn command(&self) -> Twist<T> {
        self.report()
            .map_or(Twist::default(), |report| report.command)
    }

    /// What the wheels really exert until the next tick; whether a law is at work that needs it.
    ///
    /// # Errors
    /// A torque that is not finite.
    pub(super) fn note_exerted(&mut self, torques: &WheelTorques<T>) -> Result<bool, StepFault> {
        match &mut self.motion {
            Some(controller) => controller.note_applied(torques).map(|()| true),
            None => Ok(false),
        }
    }
}

/// Torques of a step, and what a motor driver needs with them.
fn drive<T: Scalar>(
    motion: &ValidMotionParams<T>,
    report: &MotionReport<T>,
    speeds: WheelSpeeds<T>,
    beyond_coulomb: Option<WheelTorques<T>>,
) -> WheelAction<T> {
    WheelAction::Drive(DriveCommand {
        torques: report.torques,
        desired: motion.wheels().wheel_speeds(&report.command),
        speeds,
        beyond_coulomb,
    })
}
