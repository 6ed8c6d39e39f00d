//! The realistic plant behind the hardware traits: torques in, counts, supply, currents and time out.

use super::convert;
use crate::world::{Actuation, ActuationError, World};
use controller_core::base::Sensed;
use controller_core::gyro::GyroReading;
use controller_core::hal::{
    Clock, ErrorKind, ErrorType, Observed, WheelCounts, WheelDrive, WheelEncoders, YawGyro,
};
use controller_core::motor::Driver;
use controller_core::types::WheelTorques;
use firmware_demo::drive::{DriveOutput, SimulatedDrive};
use protocol::pil::WheelOutput;

/// A [`World`] as a control task sees it: drivers, encoders and clock of a base whose world it owns.
///
/// Nothing moves but in [`advance`](Self::advance). Drivers that fail or report too much current
/// ([`PlantFault`](crate::world::PlantFault)) answer so to every call.
#[derive(Clone, Debug)]
pub struct PlantHal {
    world: World,
    drive: SimulatedDrive,
    actuation: Actuation,
}

impl PlantHal {
    /// Released wheels in a world. Without motors they take torques up to `max_torque_nm`.
    pub fn new(world: World, driver: &Driver<f32>, max_torque_nm: f32) -> Self {
        Self {
            world,
            drive: SimulatedDrive::new(driver, max_torque_nm),
            actuation: Actuation::Release,
        }
    }

    /// Lets a tick pass with what the wheels do held, and returns its length \[µs\].
    ///
    /// # Errors
    /// A command that the world refuses, which no driver gives.
    pub fn advance(&mut self, period_us: u32) -> Result<u32, ActuationError> {
        let dt_us = self.world.next_tick_us(period_us);
        self.world.advance(&self.actuation, dt_us)?;
        Ok(dt_us)
    }

    /// Everything that a base measures at the end of a tick.
    pub fn sensed(&self) -> Sensed<f32> {
        convert::sensed(&self.world)
    }

    /// A call of the drivers, which answer as the world has it.
    fn call(
        &mut self,
        call: impl FnOnce(&mut SimulatedDrive) -> Result<(), ErrorKind>,
    ) -> Result<(), ErrorKind> {
        self.drive.set_answer(self.world.drive_answer());
        let answer = call(&mut self.drive);
        self.actuation = self.drive.output().into();
        answer
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The world, to put faults into.
    pub const fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// What the drivers put out since their last call.
    pub const fn output(&self) -> &WheelOutput {
        self.drive.output()
    }

    /// What acts on the wheels until the next call.
    pub const fn actuation(&self) -> &Actuation {
        &self.actuation
    }

    /// Lets something else act: a driver that does not do what it is asked for.
    pub const fn override_actuation(&mut self, actuation: Actuation) {
        self.actuation = actuation;
    }
}

impl ErrorType for PlantHal {
    type Error = ErrorKind;
}

impl WheelDrive for PlantHal {
    fn max_torque_nm(&self) -> f32 {
        self.drive.max_torque_nm()
    }

    fn observe(&mut self, observed: &Observed) {
        self.drive.observe(observed);
    }

    fn exerted(&self) -> Option<WheelTorques<f32>> {
        self.drive.exerted()
    }

    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), ErrorKind> {
        self.call(|drive| drive.set_torques(torques))
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        self.call(SimulatedDrive::release)
    }

    fn brake(&mut self) -> Result<(), ErrorKind> {
        self.call(SimulatedDrive::brake)
    }
}

impl DriveOutput for PlantHal {
    fn output(&self) -> WheelOutput {
        *self.drive.output()
    }
}

impl WheelEncoders for PlantHal {
    fn counts(&mut self) -> Result<WheelCounts, ErrorKind> {
        self.world.counts()
    }
}

impl YawGyro for PlantHal {
    fn reading(&mut self) -> Result<Option<GyroReading<f32>>, ErrorKind> {
        Ok(convert::gyro(&self.world))
    }
}

impl Clock for PlantHal {
    /// The low 32 bits of the world's time.
    fn now_us(&self) -> u32 {
        self.world.now_us() as u32
    }
}
