//! A control task with mock wheels, a model of the robot and a host that talks in time.

use controller_core::base::{BaseParams, Sensed, WheelAction};
use controller_core::hal::WheelCounts;
use controller_core::maths::Single;
use controller_core::paper::params::{Params, ValidParams};
use controller_core::queue::{ReferenceProducer, ReferenceQueue, TimedReference};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::safety::supervisor::{Cause, State};
use controller_core::types::{Measured, Pose, Twist};
use firmware_demo::control::ControlTask;
use firmware_demo::drive::{Call, MockDrive};
use firmware_demo::mission::{self, Encoders};
use firmware_demo::model::Model;
use protocol::{Command, RejectReason, WirePose};

pub const PERIOD_US: u32 = 1000;
pub const MAX_TORQUE: f32 = 15.0;

pub struct Rig {
    pub task: ControlTask<'static, MockDrive>,
    pub references: ReferenceProducer<'static, f32>,
    pub model: Model,
    pub encoders: Encoders,
    pub counts: WheelCounts,
    pub now_us: u32,
    /// The host sends a heartbeat every 20 ms.
    pub host_alive: bool,
    ticks: u32,
}

pub fn params() -> BaseParams<f32> {
    mission::params(MAX_TORQUE, false).unwrap()
}

pub fn body() -> ValidParams<f32> {
    Params::paper().validate().unwrap()
}

impl Rig {
    pub fn new() -> Self {
        Self::at(Pose::default())
    }

    pub fn at(pose: Pose<f32>) -> Self {
        Self::with(params(), pose)
    }

    pub fn with(params: BaseParams<f32>, pose: Pose<f32>) -> Self {
        let queue = Box::leak(Box::new(ReferenceQueue::<f32, 64>::new()));
        let (references, consumer) = queue.split();
        let task = ControlTask::new(MockDrive::new(MAX_TORQUE), consumer, params, pose).unwrap();
        let state = Measured {
            pose,
            ..Measured::default()
        };
        Self {
            task,
            references,
            model: Model::new(body(), state),
            encoders: Encoders::default(),
            counts: WheelCounts::default(),
            // Close to the clock's wrap-around, so that every test goes through it.
            now_us: u32::MAX - 150_500,
            host_alive: true,
            ticks: 0,
        }
    }

    pub fn command(&mut self, command: Command) -> Result<(), RejectReason> {
        self.task.command(&command)
    }

    pub fn park(&mut self, x: f32, y: f32, theta: f32) -> Result<(), RejectReason> {
        let goal = WirePose { x, y, theta };
        self.command(Command::Park { goal })
    }

    /// Samples every 0.1 s along a line at 0.4 m/s from the robot's start; the last one at rest if asked.
    pub fn line(&mut self, samples: u16, rest: bool) {
        let line = ConstantTwist {
            start: Pose::default(),
            twist: Twist::new(0.4, 0.0),
        };
        self.references.restart();
        for number in 0..samples {
            let t = f32::from(number) * 0.1;
            let reference = line.at::<Single>(t);
            let reference = if rest && number + 1 == samples {
                Reference::at_rest(*reference.pose())
            } else {
                reference
            };
            self.references
                .push(TimedReference { t, reference })
                .unwrap();
        }
    }

    /// One tick on time.
    pub fn tick(&mut self) {
        self.tick_with(PERIOD_US, |_| {});
    }

    /// Time passes, then a tick with what the sensors say, changed by `change`.
    pub fn tick_with(&mut self, elapsed_us: u32, change: impl FnOnce(&mut Sensed<f32>)) {
        let dt = elapsed_us as f32 * 1e-6;
        self.model.act(dt, self.task.output());
        self.counts = self.encoders.advance(dt, &self.model);
        let mut sensed = Sensed::of_counts(self.counts);
        change(&mut sensed);
        self.tick_sensing(elapsed_us, &sensed);
    }

    /// A tick that senses this, whatever the robot does.
    pub fn tick_sensing(&mut self, elapsed_us: u32, sensed: &Sensed<f32>) {
        self.now_us = self.now_us.wrapping_add(elapsed_us);
        if self.host_alive && self.ticks.is_multiple_of(20) {
            self.command(Command::Heartbeat).unwrap();
        }
        self.ticks += 1;
        let calls = self.task.drive_mut().calls();
        self.task.tick(self.now_us, sensed);
        let output = *self.task.output();
        let state = self.task.state();
        let drive = self.task.drive_mut();
        let new = drive.calls() - calls;
        if new == 1 {
            let applied = match output {
                WheelAction::Drive(drive) => Call::Set(drive.torques),
                WheelAction::Brake => Call::Brake,
                WheelAction::Release => Call::Release,
            };
            // A driver that fails to release still does what it did.
            let obeyed = drive.output() == applied
                || matches!(drive.last_calls().next(), Some(Call::Release));
            assert!(obeyed, "the output of the task is applied to the wheels");
        } else {
            assert_eq!(new, 2, "one call a tick, or two if the first one failed");
            assert!(matches!(drive.last_calls().next(), Some(Call::Release)));
            assert_eq!(output, WheelAction::Release);
        }
        let torque = output.torques().is_some();
        assert!(!torque || may_have_torque(state), "torque in {state:?}");
    }

    pub fn is(&self) -> (State, Cause) {
        (self.task.state(), self.task.cause())
    }

    /// Ticks until `done`, at most `most`; returns how many it took.
    pub fn run_until(&mut self, most: u32, mut done: impl FnMut(&Self) -> bool) -> u32 {
        for ticks in 0..most {
            if done(self) {
                return ticks;
            }
            self.tick();
        }
        panic!(
            "not within {most} ticks: {:?} {:?} {:?}",
            self.task.state(),
            self.task.cause(),
            self.model.measured()
        );
    }

    pub fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Armed, tracking a long line, a second into it.
    pub fn tracking() -> Self {
        let mut rig = Self::new();
        rig.command(Command::Arm).unwrap();
        rig.tick();
        rig.line(60, false);
        rig.run(1000);
        assert_eq!(rig.task.state(), State::Tracking);
        rig
    }

    /// Armed, on the way to a goal far ahead, a second into it.
    pub fn parking() -> Self {
        let mut rig = Self::new();
        rig.command(Command::Arm).unwrap();
        rig.park(3.0, 0.0, 0.0).unwrap();
        rig.run(1000);
        assert_eq!(rig.task.state(), State::Parking);
        rig
    }

    pub fn speed(&self) -> f32 {
        self.model.measured().twist.linear
    }
}

pub fn may_have_torque(state: State) -> bool {
    use State as S;
    state.drives() || matches!(state, S::Armed | S::Parked | S::Stopping(_))
}
