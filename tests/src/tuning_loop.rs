//! The motion controller on a base of `bases/`, with poses and torques that come late, for statements of the tuner.

use std::collections::VecDeque;
use std::path::Path;

use controller_core::maths::Libm;
use controller_core::motion::{MotionController, MotionParams, ValidMotionParams};
use controller_core::paper::params::Params as CoreParams;
use controller_core::shunting::ExactMean;
use controller_core::types::{Pose, Wrench};
use sim_host::mission::BaseSpec as DriveBase;

use crate::ideal::Loop;
use crate::motion_base::{Base, Body, pose};
use crate::motion_loop::Order;
use crate::oracle::Params as Constants;

/// The bases that come with the product.
pub const BASES: [&str; 3] = ["hobby-1kg", "lab-10kg", "paper-30kg"];

/// Parameters of one of them, with the gains that follow from its limits.
pub fn base(name: &str) -> MotionParams<f64> {
    DriveBase {
        gains: None,
        ..file(name)
    }
    .motion()
}

/// Parameters of one of them as it is shipped, with the gains of its file.
pub fn shipped(name: &str) -> MotionParams<f64> {
    file(name).motion()
}

/// One of them.
pub fn file(name: &str) -> DriveBase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../bases/{name}.toml"));
    DriveBase::load(&path).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What differs from what the controller believes.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Ticks by which the measured pose is old.
    pub pose_late: usize,
    /// Ticks by which the torque is late.
    pub torque_late: usize,
    /// True over believed mass and inertia.
    pub heavier: f64,
    /// Tick \[s\].
    pub dt: f64,
}

/// As believed, at 2 ms.
pub const AS_BELIEVED: Truth = Truth {
    pose_late: 0,
    torque_late: 0,
    heavier: 1.0,
    dt: 2e-3,
};

/// One instant of a run.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// Time \[s\].
    pub t: f64,
    /// True error (e_x, e_y, e_θ).
    pub error: (f64, f64, f64),
    /// A limit on acceleration, speed or torque was at work.
    pub limited: bool,
}

/// Drives from `body` for `end_s`; late poses before the start are those of the start.
pub fn drive(
    params: &MotionParams<f64>,
    truth: Truth,
    body: Body,
    order: impl Fn(f64) -> Order,
    end_s: f64,
) -> Vec<Instant> {
    let motion: ValidMotionParams<f64> = params.validate().expect("the parameters are in range");
    let robot = &params.robot;
    let plant = Base {
        mass: truth.heavier * robot.mass_kg,
        inertia: truth.heavier * robot.inertia_kg_m2,
        ..Base::of(params)
    };
    // A robot under way was there before: late poses of the start are extrapolated back.
    let earlier = |age: f64| {
        let back = -age * body.twist.linear;
        let (sine, cosine) = body.pose.theta.sin_cos();
        let (x, y) = (body.pose.x + back * cosine, body.pose.y + back * sine);
        Pose::new(x, y, body.pose.theta)
    };
    let mut poses: VecDeque<Pose<f64>> = (0..=truth.pose_late)
        .rev()
        .map(|k| earlier(k as f64 * truth.dt))
        .collect();
    let mut measured = body.measured();
    measured.pose = poses[0];
    let controller =
        MotionController::<f64, Libm, ExactMean>::start(&motion, &order(0.0), &measured)
            .expect("finite");
    let mut drive = Loop::new(controller, body, plant, truth.dt);
    let mut wrenches = VecDeque::from(vec![Wrench::default(); truth.torque_late]);
    let wheels = &robot.wheels;
    let ticks = (end_s / truth.dt).round() as u32;
    (1..=ticks)
        .map(|_| {
            let torques = drive.report().torques;
            let (right, left) = (
                torques.right / wheels.radius_right_m,
                torques.left / wheels.radius_left_m,
            );
            wrenches.push_back(Wrench {
                force: right + left,
                moment: wheels.track_m / 2.0 * (right - left),
            });
            drive.hold(&wrenches.pop_front().expect("just pushed"));
            poses.push_back(drive.body.pose);
            poses.pop_front();
            let mut measured = drive.body.measured();
            measured.pose = pose(&poses[0]);
            let order = order(drive.t);
            let step = drive.controller.step(truth.dt, &order, &measured);
            let limited = step.expect("the tick is accepted").limited;
            let error = drive.error(&order);
            Instant {
                t: drive.t,
                error: (error.x, error.y, error.theta),
                limited: limited.accel || limited.torque,
            }
        })
        .collect()
}

/// Largest size of what `part` makes of the instants of [`from`, `to`) \[s\].
pub fn peak(run: &[Instant], from: f64, to: f64, part: impl Fn(&Instant) -> f64) -> f64 {
    let inside = run.iter().filter(|now| now.t >= from && now.t < to);
    inside.map(|now| part(now).abs()).fold(0.0, f64::max)
}

/// When the size of `part` stayed below `band` \[s\].
pub fn settled(run: &[Instant], band: f64, part: impl Fn(&Instant) -> f64) -> f64 {
    let last = run.iter().rfind(|now| part(now).abs() >= band);
    last.map_or(0.0, |now| now.t)
}

/// Tuned parameters of the paper's law as the oracle's constants.
pub fn paper_constants(core: &CoreParams<f64>) -> Constants {
    let (g, p, n) = (&core.tracking, &core.parking, &core.neurons);
    Constants {
        k1: g.k1,
        k2: g.k2,
        k3: g.k3,
        kd1: g.k_d1,
        kd2: g.k_d2,
        k4: p.k4,
        k5: p.k5,
        kc1: p.k_c1,
        kc2: p.k_c2,
        a: n.a,
        b: n.b,
        d: n.d,
        ..Constants::recommended()
    }
}
