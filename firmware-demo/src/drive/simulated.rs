//! Drivers of a base whose motors are a simulation: what they would put out is there to be read.

use controller_core::hal::{ErrorKind, ErrorType, Observed, WheelDrive, accepts};
use controller_core::motor::Driver;
use controller_core::types::WheelTorques;
use protocol::pil::WheelOutput;

/// A drive that computes what it puts out, and answers what it was given to answer.
#[derive(Clone, Debug)]
pub struct SimulatedDrive {
    driver: Driver<f32>,
    max_torque_nm: f32,
    observed: Observed,
    exerted: Option<WheelTorques<f32>>,
    output: WheelOutput,
    answer: Result<(), ErrorKind>,
}

impl SimulatedDrive {
    /// Released wheels. Without motors they take torques up to `max_torque_nm`.
    pub fn new(driver: &Driver<f32>, max_torque_nm: f32) -> Self {
        Self {
            max_torque_nm: driver
                .motor()
                .map_or(max_torque_nm, |motor| motor.max_torque_nm()),
            driver: *driver,
            observed: Observed::default(),
            exerted: None,
            output: WheelOutput::Release,
            answer: Ok(()),
        }
    }

    /// What every call answers from now on.
    pub const fn set_answer(&mut self, answer: Result<(), ErrorKind>) {
        self.answer = answer;
    }

    /// What acts on the wheels until the next call.
    pub const fn output(&self) -> &WheelOutput {
        &self.output
    }

    fn stop(&mut self, output: WheelOutput) -> Result<(), ErrorKind> {
        self.output = output;
        self.exerted = None;
        self.answer
    }
}

impl ErrorType for SimulatedDrive {
    type Error = ErrorKind;
}

impl WheelDrive for SimulatedDrive {
    fn max_torque_nm(&self) -> f32 {
        self.max_torque_nm
    }

    fn observe(&mut self, observed: &Observed) {
        self.observed = *observed;
    }

    fn exerted(&self) -> Option<WheelTorques<f32>> {
        self.exerted
    }

    /// # Errors
    /// Besides those of the trait, [`ErrorKind::Other`] after a speed that is not a number; the wheels are then as they
    /// were.
    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), ErrorKind> {
        if !accepts(&torques, self.max_torque_nm) {
            return Err(ErrorKind::OutOfRange);
        }
        self.output = match &self.driver {
            Driver::Motors(motor) => {
                let commands = motor.commands(&torques, &self.observed);
                if commands.is_invalid() {
                    return Err(ErrorKind::Other);
                }
                self.exerted = commands.exerted();
                WheelOutput::Duty {
                    right: commands.right.duty,
                    left: commands.left.duty,
                }
            }
            Driver::Torques => WheelOutput::Torque {
                right: torques.right,
                left: torques.left,
            },
            Driver::Speeds(_) => WheelOutput::Speed {
                right: self.observed.desired.right,
                left: self.observed.desired.left,
            },
        };
        self.answer
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        self.stop(WheelOutput::Release)
    }

    fn brake(&mut self) -> Result<(), ErrorKind> {
        self.stop(WheelOutput::Brake)
    }
}

impl super::DriveOutput for SimulatedDrive {
    fn output(&self) -> WheelOutput {
        self.output
    }
}
