//! A control task with mock wheels, a model of the robot and a host that talks in time.
#![allow(dead_code)] // Each test file uses its part.

use controller_core::maths::Single;
use controller_core::params::{Params, Validated};
use controller_core::queue::{ReferenceProducer, ReferenceQueue, TimedReference};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::types::{Measured, Pose, Twist};
use firmware_demo::control::{ControlTask, SensorFault, Settings};
use firmware_demo::drive::MockDrive;
use firmware_demo::model::Model;
use firmware_demo::protocol::{Command, RejectReason, WirePose};
use firmware_demo::supervisor::State;

pub const PERIOD_US: u32 = 1000;
pub const MAX_TORQUE: f32 = 6.0;

pub struct Rig {
    pub task: ControlTask<'static, MockDrive>,
    pub references: ReferenceProducer<'static, f32>,
    pub model: Model,
    pub now_us: u32,
    /// The host sends a heartbeat every 20 ms.
    pub host_alive: bool,
    ticks: u32,
}

pub fn params() -> Validated<f32> {
    let mut params = Params::paper();
    params.max_wheel_torque_nm = Some(MAX_TORQUE);
    params.validate().unwrap()
}

impl Rig {
    pub fn new() -> Self {
        Self::at(Pose::default())
    }

    pub fn at(pose: Pose<f32>) -> Self {
        let queue = Box::leak(Box::new(ReferenceQueue::<f32, 64>::new()));
        let (references, consumer) = queue.split();
        let settings = Settings::default().validate().unwrap();
        let task =
            ControlTask::new(MockDrive::new(MAX_TORQUE), consumer, settings, params()).unwrap();
        let state = Measured {
            pose,
            ..Measured::default()
        };
        Self {
            task,
            references,
            model: Model::new(params(), state),
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
                Reference::at_rest::<Single>(*reference.pose())
            } else {
                reference
            };
            self.references
                .push(TimedReference { t, reference })
                .unwrap();
        }
    }

    /// One tick on time with perfect sensors. The wheels are called once.
    pub fn tick(&mut self) {
        let measured = *self.model.measured();
        self.tick_with(PERIOD_US, Ok(measured));
    }

    pub fn tick_with(&mut self, elapsed_us: u32, sensed: Result<Measured<f32>, SensorFault>) {
        self.now_us = self.now_us.wrapping_add(elapsed_us);
        if self.host_alive && self.ticks.is_multiple_of(20) {
            self.command(Command::Heartbeat).unwrap();
        }
        self.ticks += 1;
        let calls = self.task.drive_mut().calls();
        self.task.tick(self.now_us, sensed);
        let told = self.task.told();
        let state = self.task.state();
        let drive = self.task.drive_mut();
        assert!(drive.calls() - calls <= 2);
        if state != State::Fault {
            assert_eq!(drive.calls() - calls, 1, "one call a tick");
            assert_eq!(
                drive.told(),
                told,
                "what the task says is what the wheels heard"
            );
        }
        let free = told.is_none();
        assert!(
            free || state == State::Armed || state.drives(),
            "torque in {state:?}"
        );
        self.model.advance(elapsed_us as f32 * 1e-6, told);
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

    /// Armed, tracking a long line, one second into it.
    pub fn tracking() -> Self {
        let mut rig = Self::new();
        rig.command(Command::Arm).unwrap();
        rig.tick();
        rig.line(60, false);
        rig.run(1000);
        assert_eq!(rig.task.state(), State::Tracking);
        rig
    }

    pub fn speed(&self) -> f32 {
        self.model.measured().twist.linear
    }
}
