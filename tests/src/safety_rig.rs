//! A base with encoders that break, wheels that slip, a monitor and a supervisor.

use controller_core::hal::WheelCounts;
use controller_core::maths::Libm;
use controller_core::motion::{MotionController, Task, ValidMotionParams};
use controller_core::odometry::{Odometry, OdometryParams};
use controller_core::safety::supervisor::{Event, SupervisorParams};
use controller_core::safety::{
    DetectorInputs, DetectorParams, Fault, FaultKind, Monitor, OutputMode, StopPlan, Supervisor,
    ValidDetectorParams, ValidPolicyParams,
};
use controller_core::types::{Measured, Twist, WheelTorques, Wrench};

use crate::ideal::Robot;
use crate::motion_base::{Base, Body};
use crate::motion_loop::Order;
use crate::motion_tracking::Exact;

/// What an encoder makes of its wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoder {
    /// The turn.
    Sound,
    /// Nothing.
    Stuck,
    /// The turn, backward.
    Reversed,
}

/// Encoder counts per turn.
pub const COUNTS: f64 = 4096.0;
/// Inertia of a wheel without grip \[kg m²\]: 3 kg on 0.1 m.
const WHEEL_INERTIA: f64 = 0.015;
/// Time constant of the electrical brake \[s\].
pub const BRAKE_TAU: f64 = 0.15;

/// The base and all that watches over it.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Controller and robot.
    pub drive: Exact,
    /// Right and left.
    pub encoders: [Encoder; 2],
    /// The left wheel has no grip at all, and turns at this \[rad/s\].
    pub ice: Option<f64>,
    /// Outside wrench.
    pub push: Wrench<f64>,
    /// Edits the evidence before the monitor gets it.
    pub edit: fn(f64, &mut DetectorInputs<f64>),
    /// There is a source of the true twist.
    pub outside: bool,
    /// Supervisor.
    pub supervisor: Supervisor,
    /// First finding of each kind, with its time.
    pub found: Vec<(f64, Fault)>,
    /// Way of the middle of the axle \[m\], absolute.
    pub way: f64,
    monitor: Monitor<f64>,
    odometry: Odometry<f64>,
    counted: [f64; 2],
    applied: (OutputMode, WheelTorques<f64>, Twist<f64>),
    plan: Option<(StopPlan<f64>, f64)>,
}

impl Rig {
    /// Driving from `body` along `order`, ticks of `dt`.
    pub fn start(plant: Base, body: Body, order: &Order, dt: f64) -> Self {
        let params = plant.exact();
        let motion = params.validate().expect("valid");
        let settings = DetectorParams::for_base(&params, COUNTS, (1e6 * dt).round() as u32);
        let wheels = params.robot.wheels;
        let odometry = OdometryParams {
            wheels,
            calibration: controller_core::odometry::Calibration::NOMINAL,
            counts_per_turn: COUNTS,
            bandwidth: 100.0,
        };
        let controller = MotionController::start(&motion, order, &body.measured()).expect("finite");
        let valid = SupervisorParams::DEFAULT.validate().expect("valid");
        let mut supervisor = Supervisor::new(&valid);
        supervisor.on(Event::Arm);
        supervisor.on(match order {
            Task::Follow(_) => Event::Track,
            Task::Drive { .. } => Event::Drive,
            Task::Park(_) => Event::Park,
        });
        Self {
            drive: Exact::new(controller, body, plant, dt),
            encoders: [Encoder::Sound; 2],
            ice: None,
            push: Wrench::default(),
            edit: |_, _| {},
            outside: false,
            supervisor,
            found: Vec::new(),
            way: 0.0,
            monitor: Monitor::new(&settings.validate().expect("valid")),
            odometry: Odometry::new(&odometry, body.pose, WheelCounts::default()).expect("valid"),
            counted: [0.0; 2],
            applied: (OutputMode::Drive, WheelTorques::default(), Twist::default()),
            plan: None,
        }
    }

    /// The parameters that the controller has.
    pub fn motion(&self) -> &ValidMotionParams<f64> {
        self.drive.controller.motion()
    }

    /// Watches by other parameters from now on.
    pub fn set_detectors(&mut self, settings: &ValidDetectorParams<f64>) {
        self.monitor = Monitor::new(settings);
    }

    /// When a kind was found first.
    pub fn found_at(&self, kind: FaultKind) -> Option<f64> {
        let found = self.found.iter().find(|(_, fault)| fault.kind() == kind);
        found.map(|(t, _)| *t)
    }

    /// The base over a tick, then the tick.
    pub fn advance(&mut self, order: &Order) {
        self.roll();
        let (t, dt) = (self.drive.t, self.drive.dt);
        let counts = WheelCounts {
            right: self.counted[0].floor() as i32,
            left: self.counted[1].floor() as i32,
        };
        let measured = self.odometry.update::<Libm>(counts, dt);
        let (output, torques, command) = self.applied;
        let mut inputs = DetectorInputs {
            dt_us: (1e6 * dt).round() as u32,
            counts: Some(counts),
            measured,
            command,
            torques: (output != OutputMode::Brake).then_some(torques),
            outside: self.outside.then_some(self.drive.body.twist),
            ..DetectorInputs::default()
        };
        (self.edit)(t, &mut inputs);
        let found = self.monitor.check(&inputs);
        for fault in found.iter() {
            if self.found_at(fault.kind()).is_none() {
                self.found.push((t, fault));
            }
        }
        self.supervisor
            .on_active_faults(&found, &ValidPolicyParams::default());
        let Twist { linear, angular } = measured.twist;
        let rests = self.supervisor.rests(linear as f32, angular as f32);
        self.supervisor.tick(inputs.dt_us, rests);
        self.applied = self.decide(order, &measured);
    }

    /// Runs to `until`.
    pub fn run(&mut self, until: f64, order: impl Fn(f64) -> Order) {
        while self.drive.t < until {
            let order = order(self.drive.t + self.drive.dt);
            self.advance(&order);
        }
    }

    fn decide(
        &mut self,
        order: &Order,
        measured: &Measured<f64>,
    ) -> (OutputMode, WheelTorques<f64>, Twist<f64>) {
        let output = self.supervisor.output();
        let task = match output {
            OutputMode::Drive | OutputMode::Hold => *order,
            OutputMode::ControlledStop => {
                if self.plan.is_none() {
                    let report = self.drive.report();
                    let (command, rate) = (report.command, report.command_rate);
                    let plan = StopPlan::new::<Libm>(self.motion(), &command, &rate);
                    self.plan = Some((plan, self.drive.t));
                    self.drive.controller.declare_jump();
                }
                let (plan, begin) = self.plan.expect("just made");
                plan.task::<Libm>(self.drive.t - begin, self.drive.dt, &measured.pose)
            }
            OutputMode::ZeroTorque | OutputMode::Brake | OutputMode::Release => {
                return (output, WheelTorques::default(), Twist::default());
            }
        };
        let report = self.drive.controller.step(self.drive.dt, &task, measured);
        let report = report.expect("the tick is accepted");
        (output, report.torques, report.command)
    }

    fn roll(&mut self) {
        let (output, mut torques, _) = self.applied;
        let map = *self.motion().wheels();
        let before = map.wheel_speeds(&self.drive.body.twist);
        let dt = self.drive.dt;
        let mut slip = None;
        if let Some(speed) = self.ice {
            let after = speed + dt * torques.left / WHEEL_INERTIA;
            self.ice = Some(after);
            slip = Some((speed + after) / 2.0);
            torques.left = 0.0;
        }
        let Wrench { force, moment } = map.wrench(&torques);
        let wrench = Wrench {
            force: force + self.push.force,
            moment: moment + self.push.moment,
        };
        let old = self.drive.body.twist.linear;
        self.drive.roll(|body, plant, dt| {
            let mut body = body.after(plant, &wrench, dt);
            if output == OutputMode::Brake {
                let left = (-dt / BRAKE_TAU).exp();
                let twist = &mut body.twist;
                (twist.linear, twist.angular) = (twist.linear * left, twist.angular * left);
            }
            body
        });
        let twist = self.drive.body.twist;
        self.way += dt * (old + twist.linear).abs() / 2.0;
        let after = map.wheel_speeds(&twist);
        let speeds = [
            (before.right + after.right) / 2.0,
            slip.unwrap_or((before.left + after.left) / 2.0),
        ];
        for (k, speed) in speeds.into_iter().enumerate() {
            let step = speed * dt * COUNTS / std::f64::consts::TAU;
            self.counted[k] += match self.encoders[k] {
                Encoder::Sound => step,
                Encoder::Stuck => 0.0,
                Encoder::Reversed => -step,
            };
        }
    }
}
