//! From the supervisor's output to what the wheels are to do: the motion law, the stop plan, or neither.

use super::io::{DriveCommand, WheelAction};
use super::locate::Located;
use super::rolling::rolling;
use crate::error::StepFault;
use crate::maths::Maths;
use crate::motion::{Mode, MotionController, MotionReport, Outcome, Task, ValidMotionParams};
use crate::safety::{OutputMode, StopPlan};
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Measured, Twist, WheelSpeeds, WheelTorques, WheelsRolling};

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
    rolling: WheelsRolling,
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
        rolling: WheelsRolling::NONE,
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
        dt: T,
    ) -> Result<Driven<T>, StepFault> {
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
                        action: self.drive(motion, &report, speeds),
                        at_goal: matches!(task, Task::Park(_)).then_some(at_goal),
                    })
                }
                // Armed before the first reading: nothing to go by yet, so nothing is exerted.
                _ => Ok(self.without_torque()),
            },
            OutputMode::ControlledStop => match &located.measured {
                Some(measured) => {
                    let report = *self.brake_along_plan(motion, measured, jumped, dt)?;
                    Ok(Driven::only(self.drive(motion, &report, speeds)))
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

    /// Torques of a step, and what a motor driver needs with them.
    fn drive(
        &mut self,
        motion: &ValidMotionParams<T>,
        report: &MotionReport<T>,
        speeds: WheelSpeeds<T>,
    ) -> WheelAction<T> {
        let desired = motion.wheels().wheel_speeds(&report.command);
        self.rolling = if report.mode == Mode::Driving {
            rolling(self.rolling, &desired, &speeds)
        } else {
            WheelsRolling::NONE
        };
        WheelAction::Drive(DriveCommand {
            torques: report.torques,
            desired,
            speeds,
            rolling: self.rolling,
        })
    }
}
