//! Wheels that take torques or speeds: `controller_core::hal` for a test, and for real motors.

mod bridge;
mod mock;
mod motor;
mod simulated;

pub use bridge::{Bridges, MotorError, MotorSide, NoPin, OffPhase};
pub use controller_core::hal::Observed;
pub use mock::{Call, Mock, MockDrive, MockSpeedDrive, Script};
pub use motor::MotorPair;
pub use simulated::SimulatedDrive;
