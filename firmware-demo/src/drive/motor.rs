//! DC motors on half bridges: any board with a PWM output and a direction pin for each wheel.
//!
//! What a torque takes in current, voltage and duty is worked out by [`controller_core::motor`]; here are the pins.

use controller_core::hal::{ErrorType, Observed, WheelDrive, accepts};
use controller_core::motor::{Motor, WheelCommands};
use controller_core::types::WheelTorques;
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use protocol::pil::WheelOutput;

use super::DriveOutput;
use super::bridge::{Bridges, MotorError, MotorSide, NoPin};

/// Both wheels of a base. Mirrored motors are mirrored by their wiring.
#[derive(Clone, Copy, Debug)]
pub struct MotorPair<P, D, E = NoPin> {
    right: MotorSide<P, D>,
    left: MotorSide<P, D>,
    bridges: Bridges<E>,
    motor: Motor<f32>,
    observed: Observed,
    applied: WheelCommands,
    output: WheelOutput,
    backward: Option<[bool; 2]>,
}

impl<P: SetDutyCycle, D: OutputPin, E: OutputPin> MotorPair<P, D, E> {
    /// Takes the outputs; the caller calls [`release`](WheelDrive::release) before anything else.
    pub fn new(
        right: MotorSide<P, D>,
        left: MotorSide<P, D>,
        bridges: Bridges<E>,
        motor: Motor<f32>,
    ) -> Self {
        Self {
            right,
            left,
            bridges,
            motor,
            observed: Observed::default(),
            applied: WheelCommands::default(),
            output: WheelOutput::Release,
            backward: None,
        }
    }

    /// What was applied to both motors last, and what was limited; zero after a release or a brake.
    pub const fn applied(&self) -> &WheelCommands {
        &self.applied
    }

    /// What the bridges can do.
    pub const fn bridges(&self) -> &Bridges<E> {
        &self.bridges
    }

    /// The outputs, for a board that needs them back.
    pub fn into_parts(self) -> (MotorSide<P, D>, MotorSide<P, D>, Bridges<E>) {
        (self.right, self.left, self.bridges)
    }

    /// No duty on either side, tried on both.
    fn off(&mut self) -> Result<(), MotorError> {
        self.applied = WheelCommands::default();
        let (right, left) = (self.right.off(), self.left.off());
        right.and(left)
    }
}

impl<P, D, E> ErrorType for MotorPair<P, D, E> {
    type Error = MotorError;
}

impl<P: SetDutyCycle, D: OutputPin, E: OutputPin> WheelDrive for MotorPair<P, D, E> {
    fn max_torque_nm(&self) -> f32 {
        self.motor.max_torque_nm()
    }

    fn observe(&mut self, observed: &Observed) {
        self.observed = *observed;
    }

    /// By the motors' equations: torque at the wheel less its friction, where current or supply limited it.
    fn exerted(&self) -> Option<WheelTorques<f32>> {
        self.applied.exerted()
    }

    /// Directions first, each with its bridge off while it changes, then both duty cycles, then enable.
    ///
    /// # Errors
    /// Besides those of the trait, [`MotorError::Observation`] after a speed that is not a number; the wheels are then
    /// as they were.
    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), MotorError> {
        if !accepts(&torques, self.motor.max_torque_nm()) {
            return Err(MotorError::OutOfRange);
        }
        let commands = self.motor.commands(&torques, &self.observed);
        let WheelCommands { right, left } = &commands;
        if commands.is_invalid() {
            return Err(MotorError::Observation);
        }
        let desired = [right.duty < 0.0, left.duty < 0.0];
        let now = self.backward.take();
        if now != Some(desired) {
            let [to_right, to_left] = desired;
            let (from_right, from_left) = match now {
                Some([right, left]) => (Some(right), Some(left)),
                None => (None, None),
            };
            if from_right != Some(to_right) {
                self.right.off()?;
                self.right.turn(to_right)?;
            }
            if from_left != Some(to_left) {
                self.left.off()?;
                self.left.turn(to_left)?;
            }
        }
        self.right.push(right.duty)?;
        self.left.push(left.duty)?;
        self.bridges.switch(true)?;
        // Known only now: after an error the directions are set anew.
        self.backward = Some(desired);
        self.output = WheelOutput::Duty {
            right: right.duty,
            left: left.duty,
        };
        self.applied = commands;
        Ok(())
    }

    /// Enable low, no duty on either wheel, then both directions forward; each is tried whatever became of the others.
    ///
    /// Bridges that short at duty 0 and have no enable pin cannot coast: they brake; see [`Bridges`].
    fn release(&mut self) -> Result<(), MotorError> {
        self.output = WheelOutput::Release;
        self.backward = None;
        let enable = self.bridges.switch(false);
        let duties = self.off();
        let directions = (self.right.turn(false), self.left.turn(false));
        if directions == (Ok(()), Ok(())) {
            self.backward = Some([false, false]);
        }
        enable.and(duties).and(directions.0).and(directions.1)
    }

    /// No duty on either wheel, then enable high: the bridges' low phase shorts the motors.
    ///
    /// If a duty cannot be taken away, enable goes low instead, for high would drive that wheel on. Bridges that coast at
    /// duty 0 cannot brake: they are released; see [`Bridges`].
    fn brake(&mut self) -> Result<(), MotorError> {
        if !self.bridges.can_brake() {
            return self.release();
        }
        self.output = WheelOutput::Brake;
        let duties = self.off();
        let enable = self.bridges.switch(duties.is_ok());
        duties.and(enable)
    }
}

impl<P: SetDutyCycle, D: OutputPin, E: OutputPin> DriveOutput for MotorPair<P, D, E> {
    /// What was asked for last; after an error not what acts.
    fn output(&self) -> WheelOutput {
        self.output
    }
}
