//! World and base, tick by tick.

use super::{Place, convert};
use crate::drive::{Base, Mission};
use crate::world::{Actuation, ActuationError, World, WorldError};
use controller_core::base::{
    BaseController, BaseError, BaseParams, BaseReport, Order, Sensed, WheelAction,
};
use controller_core::error::ParamError;
use controller_core::robot::Robot;
use controller_core::types::{Measured, WheelTorques};

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
    /// A command that the world refuses: an error of the base.
    #[error("{0}")]
    Actuation(ActuationError),
}

/// A base in a world.
#[derive(Clone, Debug)]
pub struct Rig {
    world: World,
    base: BaseController,
    period_us: u32,
    dt_us: u32,
    actuation: Actuation,
}

impl Rig {
    /// A disarmed base that knows where it starts.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn new(mission: &Mission, place: &Place) -> Result<Self, RigError> {
        let base = (&mission.base, mission.period_s);
        Self::with(base, &mission.robot, &mission.start, place, |_| {})
    }

    /// A base by itself at the origin, with its parameters edited.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn of_base(
        base: &Base,
        place: &Place,
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
        place: &Place,
        edit: impl FnOnce(&mut BaseParams<f32>),
    ) -> Result<Self, RigError> {
        let period_us = (1.0e6 * period_s).round() as u32;
        let mut params = convert::params(base, period_us).map_err(RigError::Param)?;
        edit(&mut params);
        let valid = params.validate().map_err(RigError::Base)?;
        let keys = convert::with_hardware(&place.world, base.hardware.as_ref());
        let world = World::new(&keys.params(robot), start, place.seed);
        Ok(Self {
            world: world.map_err(RigError::World)?,
            base: BaseController::new(&valid, start.pose.cast()),
            period_us,
            dt_us: period_us,
            actuation: Actuation::Release,
        })
    }

    /// Lets the world go on to the next tick.
    ///
    /// # Errors
    /// A command that the world refuses, which no base gives.
    pub fn advance(&mut self) -> Result<(), RigError> {
        self.dt_us = self.world.next_tick_us(self.period_us);
        let moved = self.world.advance(&self.actuation, self.dt_us);
        moved.map_err(RigError::Actuation)
    }

    /// The base's tick, and what the wheels do from now on.
    pub fn tick(&mut self, order: &Order<f32>) -> &BaseReport<f32> {
        self.tick_with(order, |_| {})
    }

    /// The same with what is measured edited: faults of links between senses and base.
    pub fn tick_with(
        &mut self,
        order: &Order<f32>,
        edit: impl FnOnce(&mut Sensed<f32>),
    ) -> &BaseReport<f32> {
        let mut sensed = convert::sensed(&self.world);
        edit(&mut sensed);
        let action = self.base.tick(self.dt_us, order, &sensed).action;
        self.actuate(&action);
        self.base.report()
    }

    /// What the base would say to another order in this tick. Nothing changes.
    pub fn would_say(&self, order: &Order<f32>) -> BaseReport<f32> {
        let mut base = self.base;
        *base.tick(self.dt_us, order, &convert::sensed(&self.world))
    }

    /// The button: it reaches the wheels at once.
    pub fn emergency_stop(&mut self) {
        let action = self.base.emergency_stop();
        self.actuate(&action);
    }

    fn actuate(&mut self, action: &WheelAction<f32>) {
        self.actuation = match action {
            WheelAction::Release => Actuation::Release,
            WheelAction::Brake => Actuation::Brake,
            WheelAction::Drive(drive) => match self.base.base().motor() {
                Some(motor) => {
                    let supply_v = self.world.supply_v() as f32;
                    let (duty, exerted, limited) = convert::duties(motor, drive, supply_v);
                    if limited {
                        // Finite by the motor layer's own check.
                        let _ = self.base.note_exerted(&exerted);
                    }
                    duty
                }
                None => {
                    let WheelTorques { right, left } = drive.torques;
                    Actuation::Torque {
                        right: f64::from(right),
                        left: f64::from(left),
                    }
                }
            },
        };
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The world, to put faults into.
    pub const fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// The base.
    pub const fn base(&self) -> &BaseController {
        &self.base
    }

    /// The base, to be told something.
    pub const fn base_mut(&mut self) -> &mut BaseController {
        &mut self.base
    }

    /// Length of the last tick \[µs\].
    pub const fn dt_us(&self) -> u32 {
        self.dt_us
    }

    /// What acts on the wheels until the next tick.
    pub const fn actuation(&self) -> &Actuation {
        &self.actuation
    }

    /// Lets something else act: a driver that does not do what it is told.
    pub const fn override_actuation(&mut self, actuation: Actuation) {
        self.actuation = actuation;
    }
}
