//! World and base, tick by tick.

use super::mirror::{Mirror, MirrorError};
use super::{PlantHal, convert};
use crate::mission::{BaseSpec, Mission};
use crate::numbers::{far, param};
use crate::world::{ActuationError, World, WorldError, WorldSetup};
use controller_core::base::{BaseError, BaseParams, BaseReport, Order};
use controller_core::error::ParamError;
use controller_core::hal::Clock;
use controller_core::queue::ReferenceConsumer;
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose};
use firmware_demo::control::{ControlTask, SettingError};
use protocol::pil::{BaseInput, BaseTicked};
use protocol::{Command, RejectReason};

/// Why a base cannot be put into a world.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClosedLoopError {
    /// A parameter of the base.
    #[error("{}", param(.0))]
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
    /// The start is farther from the origin than a base may be told.
    #[error("the start, ({0}, {1}), {too_far}", too_far = far())]
    Far(f64, f64),
    /// The base somewhere else does not answer.
    #[error("{0}")]
    Mirror(String),
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
        base: &BaseSpec,
        setup: &WorldSetup,
        edit: impl FnOnce(&mut BaseParams<f32>),
    ) -> Result<Self, ClosedLoopError> {
        let period_s = base.hardware.map_or(0.01, |hardware| hardware.period_s);
        Self::with(
            (base, period_s),
            &base.robot,
            &Measured::default(),
            setup,
            edit,
        )
    }

    fn with(
        (base, period_s): (&BaseSpec, f64),
        robot: &Robot<f64>,
        start: &Measured<f64>,
        setup: &WorldSetup,
        edit: impl FnOnce(&mut BaseParams<f32>),
    ) -> Result<Self, ClosedLoopError> {
        let period_us = (1.0e6 * period_s).round() as u32;
        let mut params = convert::params(base, period_us).map_err(ClosedLoopError::Param)?;
        edit(&mut params);
        let valid = params.validate().map_err(ClosedLoopError::Base)?;
        let keys = convert::with_hardware(&setup.world, base.hardware.as_ref());
        let world =
            World::new(&keys.params(robot), start, setup.seed).map_err(ClosedLoopError::World)?;
        let most = params.motion.limits.wheel_torque_nm;
        Ok(Self {
            hal: PlantHal::new(world, valid.driver(), most),
            params,
            start: start.pose.cast(),
            period_us,
        })
    }
}

/// A base in a world, driven by orders: the firmware's control task without a host and its line.
pub struct ClosedLoop<'a> {
    task: ControlTask<'a, PlantHal>,
    mirror: Option<&'a mut dyn Mirror>,
    period_us: u32,
    dt_us: u32,
}

impl<'a> ClosedLoop<'a> {
    /// A disarmed base that knows where it starts. Orders come with each tick, so nothing goes through `references`. With a
    /// `mirror` there is the same base somewhere else, whose motors move the plant.
    ///
    /// # Errors
    /// Parameters out of their range, or no answer from there.
    pub fn new(
        references: ReferenceConsumer<'a, f32>,
        mission: &Mission,
        setup: &WorldSetup,
        mut mirror: Option<&'a mut dyn Mirror>,
    ) -> Result<Self, ClosedLoopError> {
        let at = &mission.start.pose;
        if !at.is_near() {
            return Err(ClosedLoopError::Far(at.x, at.y));
        }
        let base = (&mission.base, mission.period_s);
        let Parts {
            hal,
            params,
            start,
            period_us,
        } = Parts::with(base, &mission.robot, &mission.start, setup, |_| {})?;
        let task =
            ControlTask::new(hal, references, params, start).map_err(ClosedLoopError::Setting)?;
        if let Some(mirror) = &mut mirror {
            mirror.begin(&params, start).map_err(mirrored)?;
        }
        Ok(Self {
            task,
            mirror,
            period_us,
            dt_us: period_us,
        })
    }

    /// Lets the world go on to the next tick.
    ///
    /// # Errors
    /// A command that the world refuses, which no base gives.
    pub fn advance(&mut self) -> Result<(), ClosedLoopError> {
        let hal = self.task.drive_mut();
        self.dt_us = hal
            .advance(self.period_us)
            .map_err(ClosedLoopError::Actuation)?;
        Ok(())
    }

    /// The tick's interrupt, and what the wheels do from now on.
    ///
    /// # Errors
    /// The base somewhere else does not answer.
    pub fn tick(&mut self, order: &Order<f32>) -> Result<&BaseReport<f32>, ClosedLoopError> {
        let hal = self.task.drive();
        let (now_us, sensed) = (hal.now_us(), hal.sensed());
        self.task.tick_with(now_us, order, &sensed);
        if let Some(mirror) = &mut self.mirror {
            let input = BaseInput {
                now_us,
                order: order.into(),
                sensed,
            };
            let here = BaseTicked {
                tick: self.task.telemetry(),
                output: *self.task.drive().output(),
                instructions: 0,
            };
            let output = mirror.tick(&input, &here).map_err(mirrored)?;
            self.task.drive_mut().override_actuation((&output).into());
        }
        Ok(self.task.report())
    }

    /// A command from a host; inside what the base says of it.
    ///
    /// # Errors
    /// The base somewhere else does not answer, or otherwise.
    pub fn command(
        &mut self,
        command: &Command,
    ) -> Result<Result<(), RejectReason>, ClosedLoopError> {
        let answer = self.task.command(command);
        if let Some(mirror) = &mut self.mirror {
            mirror.command(command, answer).map_err(mirrored)?;
        }
        Ok(answer)
    }

    /// What the base would say to another order in this tick. Nothing changes.
    pub fn would_say(&self, order: &Order<f32>) -> BaseReport<f32> {
        let mut controller = *self.task.controller();
        *controller.tick(self.dt_us, order, &self.task.drive().sensed())
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        self.task.drive().world()
    }

    /// The world, to put faults into.
    pub const fn world_mut(&mut self) -> &mut World {
        self.task.drive_mut().world_mut()
    }

    /// The control task, to look at.
    pub const fn task(&self) -> &ControlTask<'a, PlantHal> {
        &self.task
    }

    /// The report of the last tick.
    pub const fn report(&self) -> &BaseReport<f32> {
        self.task.report()
    }
}

fn mirrored(error: MirrorError) -> ClosedLoopError {
    ClosedLoopError::Mirror(error.to_string())
}
