//! Wheels that take torques: `controller_core::hal::WheelDrive` for a test, and for real motors.

mod mock;
mod motor;

pub use mock::{Call, MockDrive, Script};
pub use motor::{MotorError, MotorPair, MotorParamError, MotorParams, MotorSide, ValidMotor};
