//! World and base, tick by tick.

use super::{PlantHal, convert};
use crate::mission::{Base, Mission};
use crate::world::{ActuationError, World, WorldError, WorldSetup};
use controller_core::base::{BaseController, BaseError, BaseParams, BaseReport, Order};
use controller_core::error::ParamError;
use controller_core::hal::WheelDrive;
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose};
use firmware_demo::control::SettingError;

/// Why a base cannot be put into a world.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// A parameter of the base.
    #[error("{0}")]
    Param(ParamError),
    /// A parameter of the base, or a response to a fault.
    #[error("{0}")]
    Base(BaseError),
    /// A parameter of the world.
    #[error("world.{0}")]
    World(WorldError),
    /// Parameters that the control task refuses for these wheels.
    #[error("{0}")]
    Setting(SettingError),
    /// A command that the world refuses: an error of the base.
    #[error("{0}")]
    Actuation(ActuationError),
}

/// The parts of a base in a world.
pub(super) struct Parts {
    pub hal: PlantHal,
    pub params: BaseParams<f32>,
    pub start: Pose<f32>,
    pub period_us: u32,
}

impl Parts {
    /// A base by itself at the origin, with its parameters edited.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn of_base(
        base: &Base,
        place: &WorldSetup,
        edit: impl FnOnce(&mut BaseParams<f32>),
    ) -> Result<Self, RigError> {
        let period_s = base.hardware.map_or(0.01, |hardware| hardware.period_s);
        Self::with(
            (base, period_s),
            &base.robot,
            &Measured::default(),
            place,
            edit,
        )
    }

    fn with(
        (base, period_s): (&Base, f64),
        robot: &Robot<f64>,
        start: &Measured<f64>,
        place: &WorldSetup,
        edit: impl FnOnce(&mut BaseParams<f32>),
    ) -> Result<Self, RigError> {
        let period_us = (1.0e6 * period_s).round() as u32;
        let mut params = convert::params(base, period_us).map_err(RigError::Param)?;
        edit(&mut params);
        let valid = params.validate().map_err(RigError::Base)?;
        let keys = convert::with_hardware(&place.world, base.hardware.as_ref());
        let world = World::new(&keys.params(robot), start, place.seed).map_err(RigError::World)?;
        let most = params.motion.limits.wheel_torque_nm;
        Ok(Self {
            hal: PlantHal::new(world, valid.motor().copied(), most),
            params,
            start: start.pose.cast(),
            period_us,
        })
    }
}

/// A base in a world, driven by orders: the core's base alone, without a host and its line.
#[derive(Clone, Debug)]
pub struct Rig {
    hal: PlantHal,
    base: BaseController,
    period_us: u32,
    dt_us: u32,
}

impl Rig {
    /// A disarmed base that knows where it starts.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn new(mission: &Mission, place: &WorldSetup) -> Result<Self, RigError> {
        let base = (&mission.base, mission.period_s);
        let Parts {
            hal,
            params,
            start,
            period_us,
        } = Parts::with(base, &mission.robot, &mission.start, place, |_| {})?;
        let valid = params.validate().map_err(RigError::Base)?;
        Ok(Self {
            hal,
            base: BaseController::new(&valid, start),
            period_us,
            dt_us: period_us,
        })
    }

    /// Lets the world go on to the next tick.
    ///
    /// # Errors
    /// A command that the world refuses, which no base gives.
    pub fn advance(&mut self) -> Result<(), RigError> {
        self.dt_us = self
            .hal
            .advance(self.period_us)
            .map_err(RigError::Actuation)?;
        Ok(())
    }

    /// The base's tick, and what the wheels do from now on.
    pub fn tick(&mut self, order: &Order<f32>) -> &BaseReport<f32> {
        let sensed = self.hal.sensed();
        let action = self.base.tick(self.dt_us, order, &sensed).action;
        // What a driver answers is in what the next tick measures.
        let _ = self.hal.act(&action);
        if let Some(exerted) = self.hal.exerted() {
            // Finite by the motor layer's own check.
            let _ = self.base.note_exerted(&exerted);
        }
        self.base.report()
    }

    /// What the base would say to another order in this tick. Nothing changes.
    pub fn would_say(&self, order: &Order<f32>) -> BaseReport<f32> {
        let mut base = self.base;
        *base.tick(self.dt_us, order, &self.hal.sensed())
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        self.hal.world()
    }

    /// The world, to put faults into.
    pub const fn world_mut(&mut self) -> &mut World {
        self.hal.world_mut()
    }

    /// The base.
    pub const fn base(&self) -> &BaseController {
        &self.base
    }

    /// The base, to be told something.
    pub const fn base_mut(&mut self) -> &mut BaseController {
        &mut self.base
    }
}
