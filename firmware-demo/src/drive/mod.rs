//! Wheels that take torques or speeds, and a gyro: `controller_core::hal` for a test, and for real motors.

mod bridge;
mod mock;
mod mock_gyro;
mod motor;
mod simulated;

pub use bridge::{Bridges, MotorError, MotorSide, NoPin, OffPhase};
pub use controller_core::hal::Observed;
pub use mock::{Call, Mock, MockDrive, MockSpeedDrive, Script};
pub use mock_gyro::MockGyro;
pub use motor::MotorPair;
pub use simulated::SimulatedDrive;
