//! The control task: once a tick, from a measurement to wheels that are either told a torque or released.
//!
//! It owns the supervisor's state, the controller and the wheels, and it is the only one that talks to them.
//! Torques come from the controller's report, which has them from B̄, and from nowhere else. Time and
//! measurement are arguments, so the task runs on a board, in the simulator and in tests alike.

mod drive;
mod settings;
mod watch;

pub use settings::{Arrival, LinkWatch, SettingError, Settings, StallWatch, ValidSettings};

use controller_core::hal::{Error as _, WheelDrive};
use controller_core::neural::NeuralController;
use controller_core::params::{Params, Validated};
use controller_core::queue::ReferenceConsumer;
use controller_core::types::{Measured, Pose, WheelTorques};

use crate::fault::{Cause, Fault};
use crate::protocol::{Command, RejectReason};
use crate::supervisor::{Event, Reaction, State, next};
use crate::wire::Ticked;
use watch::{Held, Overruns, Silence, Stall};

/// The encoders gave no reading in this tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SensorFault;

/// Where the robot is on its mission. What one state needs is meaningless in another, but costs no more.
#[derive(Clone, Copy, Debug, Default)]
struct Mission {
    controller: Option<NeuralController>,
    /// Commanded and not yet handed over to.
    goal: Option<Pose<f32>>,
    /// Time of the first reference \[s\], and since then.
    first_s: f32,
    run_us: u64,
    /// Parking is a controlled stop, so long already.
    braking: Option<u32>,
    arrived: Held,
    stall: Stall,
    handed_over: bool,
    ticks: u32,
}

/// Supervisor, controller and wheels. See the [module](self).
pub struct ControlTask<'queue, D> {
    drive: D,
    references: ReferenceConsumer<'queue, f32>,
    settings: ValidSettings,
    params: Validated<f32>,
    state: State,
    cause: Cause,
    changes: u32,
    last_us: Option<u32>,
    ticks: u32,
    silence: Silence,
    overruns: Overruns,
    mission: Mission,
    told: Option<WheelTorques<f32>>,
}

impl<'queue, D: WheelDrive> ControlTask<'queue, D> {
    /// A task in [`State::Idle`], which releases the wheels with its first tick.
    ///
    /// # Errors
    ///
    /// [`SettingError::TorqueLimit`] when the parameters allow more torque than the driver does.
    pub fn new(
        drive: D,
        references: ReferenceConsumer<'queue, f32>,
        settings: ValidSettings,
        params: Validated<f32>,
    ) -> Result<Self, SettingError> {
        if !within_driver(params.params(), &drive) {
            return Err(SettingError::TorqueLimit);
        }
        Ok(Self {
            drive,
            references,
            settings,
            params,
            state: State::Idle,
            cause: Cause::PowerOn,
            changes: 0,
            last_us: None,
            ticks: 0,
            silence: Silence::default(),
            overruns: Overruns::default(),
            mission: Mission::default(),
            told: None,
        })
    }

    /// Takes a command; what it asks of the wheels happens in the next tick.
    ///
    /// References do not come this way but by the queue.
    ///
    /// # Errors
    ///
    /// Why it is refused; nothing has changed then but that the host was heard.
    pub fn command(&mut self, command: &Command) -> Result<(), RejectReason> {
        self.heard();
        match command {
            Command::Heartbeat => Ok(()),
            Command::Arm => self.ask(Event::Arm),
            Command::Stop => self.ask(Event::Stop),
            Command::ResetFault => self.ask(Event::ResetFault),
            Command::Park { goal } => {
                let goal: Pose<f32> = goal.into();
                if !goal.is_finite() {
                    return Err(RejectReason::Value);
                }
                self.ask(Event::Park)?;
                self.mission.goal = Some(goal);
                Ok(())
            }
            Command::SetParameters(set) => self.set_params(Params::from(set)),
            Command::Sample(_)
            | Command::Begin { .. }
            | Command::Tick { .. }
            | Command::GetCounters => Err(RejectReason::Unsupported),
        }
    }

    /// A sound frame came from the host.
    pub const fn heard(&mut self) {
        self.silence.heard();
    }

    /// One tick at `now_us`, a clock that wraps around. Tells the wheels a torque or releases them, once; only
    /// after a driver's error are they released on top.
    pub fn tick(&mut self, now_us: u32, sensed: Result<Measured<f32>, SensorFault>) {
        let period_us = self.settings.get().period_us;
        let elapsed_us = self
            .last_us
            .map_or(period_us, |last_us| now_us.wrapping_sub(last_us));
        self.last_us = Some(now_us);
        self.ticks = self.ticks.wrapping_add(1);
        self.mission.handed_over = false;
        self.told = self.decide(elapsed_us, sensed).unwrap_or_else(|fault| {
            self.fail(fault);
            None
        });
        let done = match self.told {
            Some(torques) => self.drive.set_torques(torques),
            None => self.drive.release(),
        };
        if let Err(error) = done {
            self.fail(Fault::Driver(error.kind().into()));
            if self.told.take().is_some() {
                // If this fails too there is nothing left to do now; every tick from here on tries again.
                let _ = self.drive.release();
            }
        }
    }

    /// The supervisor's state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Why it is that.
    pub const fn cause(&self) -> Cause {
        self.cause
    }

    /// Changes of state since power-on; wraps around.
    pub const fn changes(&self) -> u32 {
        self.changes
    }

    /// Ticks since power-on; wraps around.
    pub const fn ticks(&self) -> u32 {
        self.ticks
    }

    /// What the wheels were told in the last tick; `None` when they were released.
    pub const fn told(&self) -> Option<WheelTorques<f32>> {
        self.told
    }

    /// Ticks that came late since power-on.
    pub const fn overruns(&self) -> u32 {
        self.overruns.total()
    }

    /// Everything about the last tick, while the robot is driven.
    pub fn report(&self) -> Option<Ticked> {
        let controller = self.mission.controller.as_ref()?;
        self.state.drives().then(|| Ticked {
            tick: self.mission.ticks,
            ..Ticked::of(controller, self.mission.handed_over)
        })
    }

    /// The wheels, to look at or to be told a speed. Torques are the task's business.
    pub const fn drive_mut(&mut self) -> &mut D {
        &mut self.drive
    }

    fn ask(&mut self, event: Event) -> Result<(), RejectReason> {
        match self.apply(event, Cause::Host) {
            Reaction::Refuse => Err(RejectReason::State),
            _ => Ok(()),
        }
    }

    fn set_params(&mut self, params: Params<f32>) -> Result<(), RejectReason> {
        if !matches!(self.state, State::Idle | State::Stopped) {
            return Err(RejectReason::State);
        }
        if !within_driver(&params, &self.drive) {
            return Err(RejectReason::Value);
        }
        self.params = params.validate().map_err(|_| RejectReason::Value)?;
        Ok(())
    }

    fn fail(&mut self, fault: Fault) {
        self.apply(Event::Fault, Cause::Fault(fault));
    }

    fn apply(&mut self, event: Event, cause: Cause) -> Reaction {
        let (state, reaction) = next(self.state, event);
        if state != self.state {
            self.state = state;
            self.cause = cause;
            self.changes = self.changes.wrapping_add(1);
            if !state.drives() {
                self.mission = Mission::default();
                self.references.clear();
            }
        }
        reaction
    }
}

/// The controller limits torques by itself, where it is told; so its limit has to be one that the driver takes.
fn within_driver<D: WheelDrive>(params: &Params<f32>, drive: &D) -> bool {
    params
        .max_wheel_torque_nm
        .is_some_and(|limit| limit <= drive.max_torque_nm())
}
