//! Shipped bases that roll without friction, to see what a base finds and does by itself.

use controller_core::base::{BaseController, BaseParams, BaseReport, Order, Sensed, WheelAction};
use controller_core::gyro::GyroReading;
use controller_core::hal::WheelCounts;
use controller_core::safety::Timeout;
use controller_core::safety::supervisor::Event;
use controller_core::types::{Pose, Twist, WheelTorques, Wrench};
use controller_core::wheels::WheelMap;
use sim_host::closed_loop;
use sim_host::constants::period_us;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;

/// The bases as they are shipped, but that nobody gives them poses.
pub fn shipped() -> impl Iterator<Item = (&'static str, BaseParams)> {
    with_period(period_us)
}

/// The same bases with another period \[µs\].
pub fn with_period(
    period_us: impl Fn(&BaseSpec) -> u32,
) -> impl Iterator<Item = (&'static str, BaseParams)> {
    BASES.iter().map(move |built_in| {
        let file = built_in.base().expect("in order");
        let mut params = closed_loop::params(&file, period_us(&file)).expect("in range");
        params.detectors.pose = Timeout::Off;
        (built_in.name, params)
    })
}

/// What differs from what the base believes.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Mass and inertia, as shares of the stated ones.
    pub heavy: f32,
    /// Torque exerted, as a share of what is commanded.
    pub exerted: f32,
    /// The same of the torque that its driver says it exerts.
    pub noted: f32,
    /// Force from outside, as a share of what the stated load on both wheels pushes with.
    pub loads: f32,
}

/// Nothing.
pub const AS_STATED: Truth = Truth {
    heavy: 1.0,
    exerted: 1.0,
    noted: 1.0,
    loads: 0.0,
};

/// A rigid base on wheels that roll.
pub struct Rig {
    /// What the base believes.
    pub params: BaseParams,
    /// The base itself.
    pub base: BaseController,
    /// What is true instead.
    pub truth: Truth,
    /// How it really moves.
    pub twist: Twist<f32>,
    turned: [f32; 2],
    /// Marks of the encoders that have passed, and what was counted.
    marks: [i32; 2],
    counts: [i32; 2],
    /// Counts of a mark, right and left: 1, of a dead encoder 0, of one that counts the wrong way -1.
    pub counts_per_mark: [i32; 2],
    /// Its turn rate is measured as well.
    pub gyro: bool,
}

impl Rig {
    /// Armed.
    pub fn new(params: BaseParams, truth: Truth) -> Self {
        let base = params.validate().expect("valid");
        let mut rig = Self {
            params,
            base: BaseController::new(&base, Pose::default()),
            truth,
            twist: Twist::default(),
            turned: [0.0; 2],
            marks: [0; 2],
            counts: [0; 2],
            counts_per_mark: [1; 2],
            gyro: false,
        };
        rig.tick(&Order::None);
        rig.base.on(Event::Arm);
        rig
    }

    /// Period \[s\].
    pub fn dt(&self) -> f32 {
        1e-6 * self.params.detectors.period_us as f32
    }

    /// Ticks in a time.
    pub fn ticks(&self, seconds: f32) -> u32 {
        (seconds / self.dt()) as u32
    }

    /// Speed of the faster rim, as a share of the largest.
    pub fn rim_speed(&self) -> f32 {
        let motion = &self.params.motion;
        let half_track = 0.5 * motion.robot.wheels.track_m;
        (self.twist.linear.abs() + half_track * self.twist.angular.abs()) / motion.limits.rim_speed
    }

    /// A tick, and what the base does in it.
    pub fn tick(&mut self, order: &Order) -> BaseReport {
        self.tick_after(self.params.detectors.period_us, order)
    }

    /// A tick that is as late as this after the last one.
    pub fn tick_after(&mut self, dt_us: u32, order: &Order) -> BaseReport {
        let (robot, truth, dt) = (self.params.motion.robot, self.truth, 1e-6 * dt_us as f32);
        let per_radian = self.params.localiser.odometry.counts_per_turn / core::f32::consts::TAU;
        for i in 0..2 {
            let marks = (self.turned[i] * per_radian).floor() as i32;
            self.counts[i] += self.counts_per_mark[i] * (marks - self.marks[i]);
            self.marks[i] = marks;
        }
        let [right, left] = self.counts;
        let mut sensed = Sensed::of_counts(WheelCounts { right, left });
        sensed.gyro = self.gyro.then_some(GyroReading {
            rate: self.twist.angular,
            heading: None,
            age_s: 0.0,
        });
        let report = *self.base.tick(dt_us, order, &sensed);
        let torques = report.action.torques().unwrap_or_default();
        let noted = WheelTorques {
            right: truth.noted * torques.right,
            left: truth.noted * torques.left,
        };
        self.base.note_exerted(&noted).expect("not too large");
        let wheels = WheelMap::from_geometry(&robot.wheels).expect("valid");
        let Wrench { force, moment } = wheels.wrench(&torques);
        let load_n = 2.0 * self.params.detectors.wheels.load_nm / robot.wheels.radius_right_m;
        if report.action == WheelAction::Brake {
            self.twist = Twist::default();
        } else {
            let force = truth.exerted * force + truth.loads * load_n;
            self.twist.linear += dt * force / (truth.heavy * robot.mass_kg);
            self.twist.angular += dt * truth.exerted * moment / (truth.heavy * robot.inertia_kg_m2);
        }
        let speeds = wheels.wheel_speeds(&self.twist);
        self.turned[0] += dt * speeds.right;
        self.turned[1] += dt * speeds.left;
        report
    }
}
