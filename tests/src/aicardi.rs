//! The polar law of Aicardi and others, driven both ways, through acceleration neurons: the reference
//! that the motion controller's parking is compared with. Double precision, no limits.

use std::f64::consts::{FRAC_PI_2, PI};

use controller_core::pose_error::PoseError;
use controller_core::types::{Twist, Wrench};

use crate::ideal::Loop;
use crate::motion_base::{Base, Body};
use crate::motion_loop::home;
use crate::motion_parking::{Parking, ParkingObserver};

/// Decay and bounds of its neurons.
const A: f64 = 4.0;
/// Gain on the bearing.
const TURN: f64 = 1.5;
/// Weight of the goal's heading.
const CURVE: f64 = 0.7;
/// Below this distance the heading alone is controlled \[m\].
const NEAR: f64 = 1e-3;
/// Bandwidths of the velocity loops \[1/s\].
const LOOPS: (f64, f64) = (3.0, 5.0);

/// A neuron, Eq. (4), with B = D = A: at rest it is its input.
#[derive(Clone, Copy, Debug, Default)]
struct Neuron {
    value: f64,
    input: f64,
}

impl Neuron {
    fn advance(&mut self, input: f64, dt: f64) {
        let mean = (input + self.input) / 2.0;
        let rate = A + mean.abs();
        let target = A * mean / rate;
        self.value = target + (self.value - target) * (-rate * dt).exp();
        self.input = input;
    }

    fn rate(&self) -> f64 {
        A * self.input - (A + self.input.abs()) * self.value
    }
}

/// The controller: two pose neurons (k₄ = k₅ = 1) and two acceleration neurons.
#[derive(Clone, Copy, Debug, Default)]
pub struct Aicardi {
    pose: [Neuron; 2],
    accel: [Neuron; 2],
}

impl Aicardi {
    /// The wrench of a tick; `dt` = 0 at the start.
    pub fn tick(
        &mut self,
        base: &Base,
        error: &PoseError<f64>,
        twist: &Twist<f64>,
        dt: f64,
    ) -> Wrench<f64> {
        let demands = demand(error);
        for (neuron, demand) in self.pose.iter_mut().zip(demands) {
            neuron.advance(demand, dt);
        }
        let rates = self.pose.map(|neuron| neuron.rate());
        for (neuron, rate) in self.accel.iter_mut().zip(rates) {
            neuron.advance(rate, dt);
        }
        let [v, w] = self.pose;
        let [a, alpha] = self.accel;
        Wrench {
            force: base.mass * (a.value - LOOPS.0 * (twist.linear - v.value)),
            moment: base.inertia * (alpha.value - LOOPS.1 * (twist.angular - w.value)),
        }
    }
}

fn demand(error: &PoseError<f64>) -> [f64; 2] {
    if error.x.hypot(error.y) < NEAR {
        return [error.x, error.theta];
    }
    let bearing = error.y.atan2(error.x);
    let alpha = if bearing > FRAC_PI_2 {
        bearing - PI
    } else if bearing <= -FRAC_PI_2 {
        bearing + PI
    } else {
        bearing
    };
    let beta = controller_core::angle::wrap(alpha - error.theta);
    let sinc = if alpha.abs() < 1e-6 {
        1.0
    } else {
        alpha.sin() / alpha
    };
    [
        error.x,
        TURN * alpha + alpha.cos() * sinc * (alpha + CURVE * beta),
    ]
}

/// Parks at the origin for `end_s`; from a moving start the neurons begin with its twist.
pub fn park(base: Base, body: Body, dt: f64, end_s: f64) -> Parking {
    let mut law = Aicardi::default();
    // A neuron's value is its output, the desired twist itself.
    law.pose[0].value = body.twist.linear;
    law.pose[1].value = body.twist.angular;
    let goal = home()(0.0);
    let error = |body: &Body| {
        controller_core::pose_error::pose_error::<f64, controller_core::maths::Libm>(
            &crate::motion_loop::goal(&goal),
            &body.pose,
        )
    };
    let mut drive = Loop::new(law, body, base, dt);
    let mut wrench = drive
        .controller
        .tick(&base, &error(&body), &body.twist, 0.0);
    let mut observer = ParkingObserver::start(&wrench);
    let ticks = (end_s / dt).round() as u32;
    for _ in 1..=ticks {
        drive.hold(&wrench);
        let Loop { body, t, .. } = drive;
        wrench = drive.controller.tick(&base, &error(&body), &body.twist, dt);
        observer.tick(t, dt, &error(&body), &wrench);
    }
    let left = error(&drive.body);
    observer.end(left.x.hypot(left.y) < 1e-3 && left.theta.abs() < 1e-3)
}
