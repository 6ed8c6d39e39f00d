//! From the supervisor's output to what the wheels are told.

use super::*;

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>, const N: usize> BaseController<T, M, U, N> {
    /// What the wheels are to do. A step that the motion law refuses is a fault, whose reaction takes
    /// its place in this very tick.
    pub(super) fn act(
        &mut self,
        dt: T,
        located: &Located<T>,
        findings: &mut Findings,
    ) -> WheelAction<T> {
        let mode = self.supervisor.output();
        match self.act_as(mode, dt, located) {
            Ok(action) => action,
            Err(fault) => {
                let mut found = Findings::NONE;
                found.add(fault.into());
                findings.add(fault.into());
                self.supervisor.on_findings(&found, &self.base.policy);
                // Nothing that a policy allows for a refused step steps the law again.
                let mode = match self.supervisor.output() {
                    mode if mode.has_torque() => OutputMode::Release,
                    mode => mode,
                };
                self.act_as(mode, dt, located)
                    .unwrap_or(WheelAction::Release)
            }
        }
    }

    fn act_as(&mut self, mode: OutputMode, dt: T, located: &Located<T>) -> Stepped<T> {
        if mode != OutputMode::ControlledStop {
            self.stop = None;
        }
        match mode {
            OutputMode::Drive | OutputMode::Hold => match (&self.task, &located.measured) {
                (Some(task), Some(measured)) => {
                    let task = *task;
                    self.drive(dt, &task, measured, located.jumped)
                }
                // Armed before the first reading: nothing to go by yet, so nothing is exerted.
                _ => Ok(self.idle(true)),
            },
            OutputMode::ControlledStop => match &located.measured {
                Some(measured) => self.brake_along_plan(dt, measured, located.jumped),
                None => Ok(self.idle(true)),
            },
            OutputMode::ZeroTorque => Ok(self.idle(true)),
            OutputMode::Brake => {
                self.idle(false);
                Ok(WheelAction::Brake)
            }
            OutputMode::Release => Ok(self.idle(false)),
        }
    }

    /// No law at work: enabled at zero torque, or released.
    fn idle(&mut self, enabled: bool) -> WheelAction<T> {
        self.motion = None;
        if enabled {
            WheelAction::Drive(Drive::default())
        } else {
            self.task = None;
            WheelAction::Release
        }
    }

    fn drive(&mut self, dt: T, task: &Task<T>, measured: &Measured<T>, jumped: bool) -> Stepped<T> {
        let report = match &mut self.motion {
            None => {
                let motion = MotionController::start(&self.base.motion, task, measured)?;
                *self.motion.insert(motion).report()
            }
            Some(motion) => {
                if jumped {
                    motion.declare_jump();
                }
                *motion.step(dt, task, measured)?
            }
        };
        if matches!(task, Task::Park(_)) {
            if report.outcome == Outcome::Parked {
                self.supervisor.on(Event::Reached);
            } else if self.supervisor.state() == State::Parked {
                // Pushed off its goal, it drives back, and is watched like any base that drives.
                self.supervisor.on(Event::Park);
            }
        }
        let wheels = self.base.motion.wheels();
        Ok(WheelAction::Drive(Drive {
            torques: report.torques,
            wanted: wheels.wheel_speeds(&report.command),
            speeds: self.locator.wheel_speeds(),
        }))
    }

    /// The controlled stop: the motion law along a plan that begins at its last command.
    fn brake_along_plan(&mut self, dt: T, measured: &Measured<T>, jumped: bool) -> Stepped<T> {
        let (plan, t) = match self.stop {
            Some((plan, t)) => (plan, t + dt),
            None => {
                let command = match &self.motion {
                    Some(motion) => motion.report().command,
                    None => measured.twist,
                };
                let plan = StopPlan::new::<M>(&self.base.motion, &command);
                (plan, T::ZERO)
            }
        };
        let first = self.stop.is_none();
        self.stop = Some((plan, t));
        let task = plan.task::<M>(t, dt, &measured.pose);
        self.drive(dt, &task, measured, jumped || first)
    }
}
