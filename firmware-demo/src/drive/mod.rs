//! Wheels that take torques or speeds, and a gyro: `controller_core::hal` for a test, and for real motors.

mod bridge;
mod mock;
mod mock_gyro;
mod motor;
mod simulated;

pub use bridge::{Bridges, MotorError, MotorSide, NoPin, OffPhase};
pub use controller_core::hal::{Call, Observed};
pub use mock::{Mock, MockDrive, MockSpeedDrive, Script};
pub use mock_gyro::MockGyro;
pub use motor::MotorPair;
pub use simulated::SimulatedDrive;

use controller_core::hal::{BySpeed, WheelDrive, WheelSpeedDrive};
use controller_core::types::WheelSpeeds;
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

impl<D: WheelSpeedDrive> DriveOutput for BySpeed<D> {
    /// What was asked for last; after an error not what acts.
    fn output(&self) -> WheelOutput {
        match *self.asked() {
            Call::Release => WheelOutput::Release,
            Call::Brake => WheelOutput::Brake,
            Call::Set(WheelSpeeds { right, left }) => WheelOutput::Speed { right, left },
        }
    }
}
