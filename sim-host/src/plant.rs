//! The robot itself: Eqs. (1) and (3) under wheel torques that are held between ticks.
//!
//! Written from the equations with nothing of the controller in it, so that an error there
//! cannot hide behind the same error here.

use controller_core::maths::{Libm, Maths};
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use nalgebra::{Vector2, Vector3};

/// Longest integration step \[s\].
pub const MAX_SUBSTEP_S: f64 = 0.25e-3;

/// A two-wheeled base that neither slips nor skids, in double precision.
///
/// Under held torques v and w are linear in time, and so they are computed; θ is a quadratic and
/// the classical Runge-Kutta method exact for it. x and y carry its error: with
/// f = v cos θ, at most T h⁴/2880 · max|f⁗| over a time T, for the substep h ≤ 0.25 ms. A robot
/// at 1 m/s and 2 rad/s that accelerates at 5 m/s² and 10 rad/s² has |f⁗| < 2e3, which leaves
/// 3e-15 m per second. Rounding is larger: half a unit in the last place of each coordinate per
/// call of [`Plant::advance`]. The controller's own sampling error at 1 ms is some 1e-4 m.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    robot: Robot<f64>,
    /// (x, y, θ).
    posture: Vector3<f64>,
    /// (v, w).
    velocity: Vector2<f64>,
}

impl Plant {
    /// A robot at `start`.
    pub fn new(robot: Robot<f64>, start: &Measured<f64>) -> Self {
        let Measured { pose, twist } = start;
        Self {
            robot,
            posture: Vector3::new(pose.x, pose.y, pose.theta),
            velocity: Vector2::new(twist.linear, twist.angular),
        }
    }

    /// Pose and twist as they truly are.
    pub fn truth(&self) -> Measured<f64> {
        Measured {
            pose: Pose::new(self.posture.x, self.posture.y, self.posture.z),
            twist: Twist::new(self.velocity.x, self.velocity.y),
        }
    }

    /// Moves on by `dt` \[s\] with both wheel torques held.
    pub fn advance(&mut self, torques: &WheelTorques<f64>, dt: f64) {
        let acceleration = self.acceleration(torques);
        let start = self.velocity;
        let substeps = (dt / MAX_SUBSTEP_S).ceil().max(1.0);
        let h = dt / substeps;
        // The way of this tick on its own, added once: small numbers keep their digits, and equal
        // substeps do not round the same way a thousand times.
        let mut moved = Vector3::zeros();
        for substep in 0..substeps as usize {
            let velocity = |share: f64| start + acceleration * (h * (substep as f64 + share));
            moved = runge_kutta(&moved, self.posture.z, h, velocity);
        }
        self.posture += moved;
        self.velocity = start + acceleration * dt;
    }

    /// Eq. (3), with each wheel's push on the ground τ/r and its lever arm l/2.
    fn acceleration(&self, torques: &WheelTorques<f64>) -> Vector2<f64> {
        let Robot {
            mass_kg,
            inertia_kg_m2,
            wheels,
        } = &self.robot;
        let right = torques.right / wheels.radius_right_m;
        let left = torques.left / wheels.radius_left_m;
        Vector2::new(
            (right + left) / mass_kg,
            (right - left) * (0.5 * wheels.track_m) / inertia_kg_m2,
        )
    }
}

/// Eq. (1).
fn posture_rate(heading: f64, velocity: &Vector2<f64>) -> Vector3<f64> {
    let (sine, cosine) = Libm::sin_cos(heading);
    Vector3::new(velocity.x * cosine, velocity.x * sine, velocity.y)
}

/// One classical step of Eq. (1) for a robot that has `moved` since its heading was `heading`;
/// `velocity` is (v, w) at a share of the step.
fn runge_kutta(
    moved: &Vector3<f64>,
    heading: f64,
    h: f64,
    velocity: impl Fn(f64) -> Vector2<f64>,
) -> Vector3<f64> {
    let rate = |turned: f64, velocity: &Vector2<f64>| posture_rate(heading + turned, velocity);
    let (first, middle, last) = (velocity(0.0), velocity(0.5), velocity(1.0));
    let a = rate(moved.z, &first);
    let b = rate(moved.z + 0.5 * h * a.z, &middle);
    let c = rate(moved.z + 0.5 * h * b.z, &middle);
    let d = rate(moved.z + h * c.z, &last);
    moved + (a + (b + c) * 2.0 + d) * (h / 6.0)
}
