//! The control task: once a tick, from counts to wheels that exert a torque, brake, or are released.
//!
//! It owns the base of the core (localiser, monitor, supervisor, motion law), the wheels and the queue of references, and it is the
//! only one that talks to the wheels. What is wrong and what is done about it is decided in
//! [`controller_core::safety`]; here references become orders. Time and measurement are arguments,
//! so the task runs on a board, in the simulator and in tests alike.

mod commands;
mod course;
mod settings;

pub use settings::{SetError, SettingError};

use controller_core::base::{BaseController, BaseParams, BaseReport, Order, Sensed, WheelAction};
use controller_core::hal::{ErrorKind, WheelDrive};
use controller_core::localiser::Fix;
use controller_core::queue::ReferenceConsumer;
use controller_core::safety::Silence;
use controller_core::safety::supervisor::{Cause, Event, State};
use controller_core::types::{Pose, WheelTorques};
use protocol::{BaseTick, RecordingEnd};

use course::Course;

/// Base, wheels and references. See the [module](self).
pub struct ControlTask<'queue, D> {
    drive: D,
    references: ReferenceConsumer<'queue, f32>,
    controller: BaseController,
    params: BaseParams<f32>,
    defaults: BaseParams<f32>,
    course: Course,
    /// Why the last excitation ended; what is not noted here ended it from outside.
    excitation_end: RecordingEnd,
    /// Since the last heartbeat of the host.
    heartbeat: Silence,
    /// An external pose for the next tick.
    fix: Option<Fix<f32>>,
    /// That of the last tick.
    fix_taken: Option<Fix<f32>>,
    /// What the driver answered last.
    answer: Result<(), ErrorKind>,
    /// What is applied to the wheels.
    output: WheelAction<f32>,
    last_us: Option<u32>,
    ticks: u32,
    changes: u32,
}

impl<'queue, D: WheelDrive> ControlTask<'queue, D> {
    /// A task in [`State::Idle`] at `start`, which releases the wheels with its first tick. `defaults` are what it is compiled with.
    ///
    /// # Errors
    ///
    /// [`SettingError`]: parameters out of range, or that allow more torque than the driver does.
    // What it needs of the stack is free again while the task runs.
    #[inline(never)]
    pub fn new(
        drive: D,
        references: ReferenceConsumer<'queue, f32>,
        defaults: BaseParams<f32>,
        start: Pose<f32>,
    ) -> Result<Self, SettingError> {
        let checked = settings::check(&defaults, &drive);
        let base = checked.as_ref().map_err(|error| *error)?;
        Ok(Self {
            drive,
            references,
            controller: BaseController::new(base, start),
            params: defaults,
            defaults,
            course: Course::default(),
            excitation_end: RecordingEnd::Stopped,
            heartbeat: Silence::NONE,
            fix: None,
            fix_taken: None,
            answer: Ok(()),
            output: WheelAction::Release,
            last_us: None,
            ticks: 0,
            changes: 0,
        })
    }

    /// A sound frame came from the host, or a mission without a host is alive.
    pub const fn host_seen(&mut self) {
        self.controller.frame_seen();
    }

    /// A heartbeat of the host: what an excitation needs beside frames of whomever.
    pub const fn heartbeat_seen(&mut self) {
        self.heartbeat = Silence::NONE;
    }

    /// One tick at `now_us`, a clock that wraps around. `sensed.driver` is not looked at: the task has the driver's answer.
    ///
    /// One output is applied in each tick; only after a driver's error are the wheels released on top, in the same tick.
    pub fn tick(&mut self, now_us: u32, sensed: &Sensed<f32>) -> &BaseReport<f32> {
        let elapsed_us = self.elapsed_us(now_us);
        self.controller.watch_link(elapsed_us);
        let order = self.order(elapsed_us);
        self.run(elapsed_us, &order, sensed)
    }

    /// The same for a caller that is its own host: it gives the order of each tick, and the order is its sign of life.
    pub fn tick_with(
        &mut self,
        now_us: u32,
        order: &Order<f32>,
        sensed: &Sensed<f32>,
    ) -> &BaseReport<f32> {
        let elapsed_us = self.elapsed_us(now_us);
        self.run(elapsed_us, order, sensed)
    }

    fn elapsed_us(&mut self, now_us: u32) -> u32 {
        let period_us = self.params.detectors.period_us;
        let elapsed_us = self
            .last_us
            .map_or(period_us, |last_us| now_us.wrapping_sub(last_us));
        self.last_us = Some(now_us);
        self.ticks = self.ticks.wrapping_add(1);
        elapsed_us
    }

    fn run(
        &mut self,
        elapsed_us: u32,
        order: &Order<f32>,
        sensed: &Sensed<f32>,
    ) -> &BaseReport<f32> {
        self.fix_taken = self.fix.take().or(sensed.fix);
        let sensed = Sensed {
            fix: self.fix_taken,
            driver: self.answer,
            ..*sensed
        };
        self.controller.tick(elapsed_us, order, &sensed);
        self.apply(sensed.supply_v);
        self.tidy();
        self.controller.report()
    }

    /// The button: what it asks reaches the wheels in this call, and stays until a reset.
    pub fn emergency_stop(&mut self, brake: bool) {
        self.controller.emergency_stop_by(brake);
        self.apply(None);
        self.tidy();
    }

    /// Has the wheels do what the base asks of them.
    fn apply(&mut self, supply_v: Option<f32>) {
        self.answer = self.controller.apply(&mut self.drive, supply_v);
        self.output = match self.answer {
            Ok(()) => self.controller.report().action,
            Err(_) => WheelAction::Release,
        };
    }

    /// After a change of state: nothing is left of a course that ended.
    fn tidy(&mut self) {
        let changes = self.changes();
        if changes == self.changes {
            return;
        }
        self.changes = changes;
        let state = self.state();
        if state != State::Tracking {
            self.references.clear();
        }
        if !state.drives() && state != State::Parked {
            self.course = Course::default();
        }
    }

    /// The supervisor's state.
    pub const fn state(&self) -> State {
        self.controller.supervisor().state()
    }

    /// Following references, and not driving by velocity.
    pub(crate) const fn follows(&self) -> bool {
        matches!(self.course, Course::Follow { .. })
    }

    /// Driving by itself for a recording.
    pub(crate) const fn excites(&self) -> bool {
        matches!(self.course, Course::Excite(_))
    }

    /// Why the last excitation ended.
    pub(crate) const fn excitation_end(&self) -> RecordingEnd {
        self.excitation_end
    }

    /// Ends an excitation by a controlled stop.
    pub(crate) fn end_excitation(&mut self, end: RecordingEnd) {
        if self.excites() {
            self.excitation_end = end;
            self.course = Course::None;
            self.controller.on(Event::Stop);
            self.tidy();
        }
    }

    /// The external pose of the last tick.
    pub(crate) const fn fix_taken(&self) -> Option<&Fix<f32>> {
        self.fix_taken.as_ref()
    }

    /// Why it is that.
    pub const fn cause(&self) -> Cause {
        self.controller.supervisor().cause()
    }

    /// Changes of state since power-on; wraps around.
    pub const fn changes(&self) -> u32 {
        self.controller.supervisor().changes()
    }

    /// Ticks since power-on; wraps around.
    pub const fn ticks(&self) -> u32 {
        self.ticks
    }

    /// The output to the wheels since the last tick or emergency stop.
    pub const fn output(&self) -> &WheelAction<f32> {
        &self.output
    }

    /// The torques applied; `None` when the wheels are braked or released.
    pub const fn applied(&self) -> Option<WheelTorques<f32>> {
        self.output.torques()
    }

    /// Ticks that came late.
    pub fn overruns(&self) -> u32 {
        self.controller.late_ticks()
    }

    /// Everything about the last tick.
    pub const fn report(&self) -> &BaseReport<f32> {
        self.controller.report()
    }

    /// The important terms of the last tick.
    pub fn telemetry(&self) -> BaseTick {
        let (ignored, _) = self.controller.supervisor().ignored();
        BaseTick::of(self.ticks, self.report(), ignored)
    }

    /// Ends the task; the queue is free for another.
    pub fn into_references(self) -> ReferenceConsumer<'queue, f32> {
        self.references
    }

    /// The base, to look at.
    pub const fn controller(&self) -> &BaseController {
        &self.controller
    }

    /// The parameters in use.
    pub const fn params(&self) -> &BaseParams<f32> {
        &self.params
    }

    /// The wheels, to look at.
    pub const fn drive(&self) -> &D {
        &self.drive
    }

    /// The wheels, for what else they can do. Torques are the task's business.
    pub const fn drive_mut(&mut self) -> &mut D {
        &mut self.drive
    }
}
