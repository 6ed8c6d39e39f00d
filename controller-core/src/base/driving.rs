//! From the supervisor's output to what the wheels are to do: the motion law, the stop plan, or neither.

use super::io::{DriveCommand, WheelAction};
use super::wheel_friction::{FrictionWatch, Turning};
use crate::error::StepFault;
use crate::maths::Maths;
use crate::motion::{Asked, MotionLaw, MotionReport, Outcome, PathEnd, Task, ValidMotionParams};
use crate::safety::{OutputMode, StopPlan};
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Measured, Twist, WheelSpeeds, WheelTorques};

/// What is driven, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Driving<T, M, U> {
    /// What the orders amount to.
    pub(super) task: Option<Task<T>>,
    /// Of the path that the task follows.
    pub(super) end: PathEnd<T>,
    /// At work while there is a report of it.
    law: MotionLaw<T, M, U>,
    /// Of a controlled stop, and the time since its begin \[s\].
    stop: Option<(StopPlan<T>, T)>,
    /// While driving by velocity.
    friction: Option<FrictionWatch<T>>,
}

/// A tick of a base, as far as driving goes.
pub(super) struct Tick<'a, T> {
    pub(super) motion: &'a ValidMotionParams<T>,
    /// What the supervisor lets through.
    pub(super) mode: OutputMode,
    /// `None` before the first reading.
    pub(super) measured: Option<&'a Measured<T>>,
    pub(super) jumped: bool,
    /// Of [`Taken`](super::orders::Taken).
    pub(super) other_goal: bool,
    /// Of the wheels, as measured.
    pub(super) speeds: WheelSpeeds<T>,
    /// Of a base with motors that drives by velocity.
    pub(super) turning: Option<Turning<'a, T>>,
    pub(super) dt: T,
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
        end: PathEnd::NEW,
        law: MotionLaw::IDLE,
        stop: None,
        friction: None,
    };

    /// What the wheels are to do. `report` is the motion law's of the last tick and becomes that of this one; `None` while
    /// its torque does not flow.
    ///
    /// # Errors
    /// A step that the motion law refuses.
    pub(super) fn act(
        &mut self,
        tick: &Tick<'_, T>,
        report: &mut Option<MotionReport<T>>,
    ) -> Result<Driven<T>, StepFault> {
        let beyond = self.beyond_coulomb(tick.turning.as_ref());
        if tick.mode != OutputMode::ControlledStop {
            self.stop = None;
        }
        let Tick { motion, speeds, .. } = *tick;
        match tick.mode {
            OutputMode::Drive | OutputMode::Hold => match (&self.task, tick.measured) {
                (Some(task), Some(measured)) => {
                    let (jumped, dt) = (tick.jumped, tick.dt);
                    let asked = Asked {
                        task,
                        other_goal: tick.other_goal,
                    };
                    let report = step(&mut self.law, motion, asked, measured, jumped, dt, report)?;
                    let at_goal = report.outcome == Outcome::Parked;
                    Ok(Driven {
                        action: drive(motion, report, (speeds, tick.dt), beyond),
                        at_goal: matches!(task, Task::Park(_)).then_some(at_goal),
                    })
                }
                // Armed before the first reading: nothing to go by yet, so nothing is exerted.
                _ => Ok(without_torque(report)),
            },
            OutputMode::ControlledStop => match tick.measured {
                Some(measured) => {
                    let report = self.brake_along_plan(tick, measured, report)?;
                    Ok(Driven::only(drive(
                        motion,
                        report,
                        (speeds, tick.dt),
                        beyond,
                    )))
                }
                None => Ok(without_torque(report)),
            },
            OutputMode::ZeroTorque => Ok(without_torque(report)),
            OutputMode::Brake => {
                self.let_go(report);
                Ok(Driven::only(WheelAction::Brake))
            }
            OutputMode::Release => {
                self.let_go(report);
                Ok(Driven::only(WheelAction::Release))
            }
        }
    }

    /// What the wheels' friction is found to be beyond its Coulomb part, while the base drives by velocity and has motors.
    fn beyond_coulomb(&mut self, turning: Option<&Turning<'_, T>>) -> Option<WheelTorques<T>> {
        let Some(turning) = turning else {
            self.friction = None;
            return None;
        };
        let watch = self.friction.get_or_insert_default();
        Some(watch.advance(turning))
    }

    /// The controlled stop: the motion law along a plan that begins at its last command.
    fn brake_along_plan<'r>(
        &mut self,
        tick: &Tick<'_, T>,
        measured: &Measured<T>,
        report: &'r mut Option<MotionReport<T>>,
    ) -> Result<&'r MotionReport<T>, StepFault> {
        let &Tick { motion, dt, .. } = tick;
        let (plan, t) = match self.stop {
            Some((plan, t)) => (plan, t + dt),
            None => {
                let command = match report {
                    Some(report) => report.command,
                    None => measured.twist,
                };
                (StopPlan::new::<M>(motion, &command), T::ZERO)
            }
        };
        let first = self.stop.is_none();
        self.stop = Some((plan, t));
        let task = plan.task::<M>(t, dt, &measured.pose);
        let jumped = tick.jumped || first;
        let asked = Asked {
            task: &task,
            other_goal: false,
        };
        step(&mut self.law, motion, asked, measured, jumped, dt, report)
    }

    fn let_go(&mut self, report: &mut Option<MotionReport<T>>) {
        *report = None;
        self.task = None;
    }

    /// What the wheels really exert until the next tick, for a law at work.
    ///
    /// # Errors
    /// A torque that is not finite.
    pub(super) fn note_exerted(
        &mut self,
        motion: &ValidMotionParams<T>,
        torques: &WheelTorques<T>,
    ) -> Result<(), StepFault> {
        self.law.note_applied(motion, torques)
    }
}

/// The motion law's step, or its start where there is no report yet.
fn step<'r, T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    law: &mut MotionLaw<T, M, U>,
    motion: &ValidMotionParams<T>,
    asked: Asked<'_, T>,
    measured: &Measured<T>,
    jumped: bool,
    dt: T,
    report: &'r mut Option<MotionReport<T>>,
) -> Result<&'r MotionReport<T>, StepFault> {
    let starts = report.is_none();
    let current = report.get_or_insert_default();
    let taken = if starts {
        law.begin(motion, asked.task, measured, current)
    } else {
        if jumped {
            law.declare_jump();
        }
        law.step(motion, dt, asked, measured, current)
    };
    match taken {
        Ok(()) => Ok(report.get_or_insert_default()),
        Err(fault) => {
            if starts {
                *report = None;
            }
            Err(fault)
        }
    }
}

/// Enabled, with no law at work.
fn without_torque<T: Scalar>(report: &mut Option<MotionReport<T>>) -> Driven<T> {
    *report = None;
    Driven::only(WheelAction::Drive(DriveCommand::default()))
}

/// Torques of a step, and what a motor driver needs with them: the measured `speeds` go on as commanded over half a tick of `dt`.
fn drive<T: Scalar>(
    motion: &ValidMotionParams<T>,
    report: &MotionReport<T>,
    (speeds, dt): (WheelSpeeds<T>, T),
    beyond_coulomb: Option<WheelTorques<T>>,
) -> WheelAction<T> {
    let half = T::HALF * dt;
    let gained = Twist {
        linear: half * report.command_rate.linear,
        angular: half * report.command_rate.angular,
    };
    let gained = motion.wheels().wheel_speeds(&gained);
    WheelAction::Drive(DriveCommand {
        torques: report.torques,
        desired: motion.wheels().wheel_speeds(&report.command),
        speeds: WheelSpeeds {
            right: speeds.right + gained.right,
            left: speeds.left + gained.left,
        },
        beyond_coulomb,
    })
}
