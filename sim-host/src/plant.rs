//! The robot itself: Eqs. (1) and (3) under wheel torques that are held between ticks.
//!
//! Written from the equations with nothing of the controller in it, so that an error there
//! cannot hide behind the same error here.

use controller_core::maths::{Libm, Maths};
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use nalgebra::{Vector2, Vector3};

/// Longest step over which the way is integrated at once \[s\].
const MAX_SUBSTEP_S: f64 = 5.0e-3;

/// Nodes and weights of Gauss and Legendre on (0, 1): (1 ± √0.6)/2 and 1/2; 5/18 and 4/9.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// A two-wheeled base that neither slips nor skids, in double precision.
///
/// Under held torques v and w are linear in time and θ is a quadratic, and so they are computed. x and y are integrals of
/// v cos θ and v sin θ, by three nodes of Gauss and Legendre: with f = v cos θ, the error is at most
/// T h⁶/2016000 · max|f⁽⁶⁾| over a time T, for the substep h ≤ 5 ms. A robot at 1 m/s and 2 rad/s that accelerates at 5 m/s²
/// and 10 rad/s² has |f⁽⁶⁾| < 1.6e5, which leaves 1.3e-15 m per second. Rounding is larger: half a unit in the last place
/// of each coordinate per call of [`Plant::advance`]. The controller's own sampling error at 1 ms is some 1e-4 m.
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
        let turned = |t: f64| (start.y + 0.5 * acceleration.y * t) * t;
        let substeps = (dt / MAX_SUBSTEP_S).ceil().max(1.0);
        let h = dt / substeps;
        // The way of this tick on its own, added once: small numbers keep their digits, and equal
        // substeps do not round the same way a thousand times.
        let mut way = Vector2::zeros();
        for substep in 0..substeps as usize {
            for (node, weight) in GAUSS {
                let t = h * (substep as f64 + node);
                let speed = start.x + acceleration.x * t;
                way += Self::rate(self.posture.z + turned(t), speed) * (weight * h);
            }
        }
        self.posture += Vector3::new(way.x, way.y, turned(dt));
        self.velocity = start + acceleration * dt;
    }

    /// Eq. (1) of x and y, where w has no part.
    fn rate(heading: f64, speed: f64) -> Vector2<f64> {
        let (sine, cosine) = Libm::sin_cos(heading);
        Vector2::new(speed * cosine, speed * sine)
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
