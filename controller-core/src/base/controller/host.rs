//! What comes from outside of the tick: commands, poses, what the wheels really did.

use super::*;
use crate::error::Input;

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>, const N: usize> BaseController<T, M, U, N> {
    /// A command of the host or an event of the mission, such as `Event::Arm`, `Event::Stop` or
    /// `Event::Reset`; what it asks of the wheels happens in the next tick.
    pub fn on(&mut self, event: Event) -> Action {
        self.silent_us = 0;
        self.supervisor.on(event)
    }

    /// The button. What it returns is to reach the wheels at once; the ticks that follow say the same.
    pub fn emergency_stop(&mut self) -> WheelAction<T> {
        self.supervisor.emergency_stop();
        self.cut()
    }

    /// As [`emergency_stop`](Self::emergency_stop), but whether to brake or to release is said here.
    pub fn emergency_stop_by(&mut self, brake: bool) -> WheelAction<T> {
        self.supervisor.on(Event::EmergencyStop { brake });
        self.cut()
    }

    fn cut(&mut self) -> WheelAction<T> {
        let action = match self.supervisor.output() {
            OutputMode::Brake => WheelAction::Brake,
            _ => WheelAction::Release,
        };
        self.motion = None;
        self.stop = None;
        self.task = None;
        self.exerted = WheelTorques::default();
        self.report.action = action;
        action
    }

    /// The host is alive, though it has no order.
    pub fn heard(&mut self) {
        self.silent_us = 0;
    }

    /// Puts the base elsewhere on the map. Command and torque go on without a step.
    ///
    /// # Errors
    /// A pose that is not finite; nothing has changed then.
    pub fn set_pose(&mut self, pose: Pose<T>) -> Result<(), StepFault> {
        if !pose.is_finite() {
            return Err(StepFault::NotFinite(Input::Pose));
        }
        self.locator.set_pose(pose);
        Ok(())
    }

    /// Takes other parameters: where the base is and what latched stays, what the localiser and the monitor have learnt begins
    /// anew.
    ///
    /// # Errors
    /// [`StepFault::WrongPhase`] while the base is live: only Idle, Stopped and Fault are left alone by new gains.
    pub fn reconfigure(&mut self, base: &Base<T>) -> Result<(), StepFault> {
        if self.supervisor.state().is_live() {
            return Err(StepFault::WrongPhase);
        }
        self.base = *base;
        self.locator = self.locator.renewed(&base.localisation);
        self.monitor = Monitor::new(&base.watch);
        self.supervisor.reconfigure(&base.supervisor);
        self.motion = None;
        self.stop = None;
        self.task = None;
        Ok(())
    }

    /// Ticks that came late, by the watch over them, since the start or the last new parameters.
    pub fn late_ticks(&self) -> u32 {
        self.monitor.late_ticks()
    }

    /// What the wheels really exert until the next tick, where the driver could not do what it was
    /// told: for the estimates of speed and disturbance.
    ///
    /// # Errors
    /// A torque that is not finite; nothing is noted then.
    pub fn note_exerted(&mut self, torques: &WheelTorques<T>) -> Result<(), StepFault> {
        if let Some(motion) = &mut self.motion {
            motion.note_applied(torques)?;
            self.exerted = *torques;
        }
        Ok(())
    }
}
