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

use controller_core::hal::WheelDrive;
use protocol::pil::WheelOutput;

/// A drive that says what it puts out, which a bench recording has of every tick.
pub trait DriveOutput: WheelDrive {
    /// What acts on the wheels since the last call.
    fn output(&self) -> WheelOutput;
}

impl<D: DriveOutput + ?Sized> DriveOutput for &mut D {
    fn output(&self) -> WheelOutput {
        (**self).output()
    }
}
