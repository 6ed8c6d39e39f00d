//! The firmware on the plant, with a host at the other end of a line.

use super::PlantHal;
use super::by_orders::{ClosedLoopError, Parts};
use super::mirror::{LineMirror, MirrorError};
use crate::mission::BaseSpec;
use crate::world::{Actuation, World, WorldSetup};
use controller_core::base::{BaseParams, BaseReport, Sensed};
use controller_core::hal::{Clock, WheelCounts};
use controller_core::types::Pose;
use firmware_demo::control::ControlTask;
use firmware_demo::control_server::{CommandReceiver, ControlServer, Queues};
use protocol::{Frame, Telemetry};

/// Decimation of reports: that of one in this many ticks is sent. A line of 115,200 baud holds ten frames of 60 bytes in 0.05 s.
const DECIMATE: u16 = 10;

/// The firmware's control server over a [`PlantHal`]: bytes in, frames out, ticks in between.
///
/// External poses do not reach it but as frames; see [`World::fix`] for what a host has to send.
pub struct Board<'queue> {
    server: ControlServer<'queue, PlantHal>,
    receiver: CommandReceiver<'queue>,
    period_us: u32,
    dt_us: u32,
    /// What the last tick sensed, and when.
    last: (u32, Sensed<f32>),
}

impl<'queue> Board<'queue> {
    /// A base by itself at the origin, disarmed, with its parameters edited.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn new(
        queues: &'queue mut Queues,
        base: &BaseSpec,
        setup: &WorldSetup,
        edit: impl FnOnce(&mut BaseParams<f32>),
    ) -> Result<Self, ClosedLoopError> {
        let Parts {
            hal,
            params,
            start,
            period_us,
        } = Parts::of_base(base, setup, edit)?;
        let (references, ends, receiver) = queues.split(DECIMATE);
        let task =
            ControlTask::new(hal, references, params, start).map_err(ClosedLoopError::Setting)?;
        Ok(Self {
            server: ControlServer::new(task, ends),
            receiver,
            period_us,
            dt_us: period_us,
            last: (0, Sensed::of_counts(WheelCounts::default())),
        })
    }

    /// Lets the world go on to the next tick.
    ///
    /// # Errors
    /// A command that the world refuses, which no task gives.
    pub fn advance(&mut self) -> Result<(), ClosedLoopError> {
        let hal = self.server.drive_mut();
        self.dt_us = hal
            .advance(self.period_us)
            .map_err(ClosedLoopError::Actuation)?;
        Ok(())
    }

    /// A byte from the line, to the background; what it answers at once.
    pub fn receive(&mut self, byte: u8) -> Option<Frame<Telemetry>> {
        self.receiver.push(byte, || 0)
    }

    /// The tick's interrupt.
    pub fn tick(&mut self) -> &BaseReport<f32> {
        let hal = self.server.drive_mut();
        let sensed = Sensed {
            fix: None,
            ..hal.sensed()
        };
        let now_us = hal.now_us();
        self.last = (now_us, sensed);
        self.server.tick(now_us, &sensed);
        self.task().report()
    }

    /// What the tick has to send, oldest first.
    pub fn pending(&mut self) -> Option<Frame<Telemetry>> {
        self.receiver.pending()
    }

    /// Begins the same base in a mirror, before the first tick.
    ///
    /// # Errors
    /// It cannot be reached, or refuses the parameters.
    pub fn begin_mirror(&self, mirror: &mut dyn LineMirror) -> Result<(), MirrorError> {
        mirror.begin(self.task().params(), Pose::default(), DECIMATE)
    }

    /// The tick that was just done, in the mirror: its output moves the plant from now on. Before it `line` came in; what came
    /// out is to be compared with what came out here.
    ///
    /// # Errors
    /// It cannot be reached, or puts out something else.
    pub fn tick_mirror(
        &mut self,
        mirror: &mut dyn LineMirror,
        line: &[u8],
    ) -> Result<Vec<u8>, MirrorError> {
        let (now_us, sensed) = &self.last;
        let (output, bytes) = mirror.tick(line, *now_us, sensed)?;
        let here = self.task().drive().output();
        if output != *here {
            return Err(format!("{output:?} is put out there, {here:?} here").into());
        }
        self.override_actuation((&output).into());
        Ok(bytes)
    }

    /// The control task, to look at.
    pub const fn task(&self) -> &ControlTask<'queue, PlantHal> {
        self.server.task()
    }

    /// The report of the last tick.
    pub const fn report(&self) -> &BaseReport<f32> {
        self.task().report()
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        self.task().drive().world()
    }

    /// The world, to put faults into.
    pub const fn world_mut(&mut self) -> &mut World {
        self.server.drive_mut().world_mut()
    }

    /// What acts on the wheels until the next tick.
    pub const fn actuation(&self) -> &Actuation {
        self.task().drive().actuation()
    }

    /// Lets something else act: a driver that does not do what it is asked for.
    pub const fn override_actuation(&mut self, actuation: Actuation) {
        self.server.drive_mut().override_actuation(actuation);
    }

    /// Length of the last tick \[µs\].
    pub const fn dt_us(&self) -> u32 {
        self.dt_us
    }
}
