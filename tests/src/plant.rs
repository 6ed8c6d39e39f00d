//! Robot and reference between two ticks, for a held torque: Eq. (1), Eq. (3) and Eq. (6).

use nalgebra::{Vector2, Vector3};

use crate::ideal::Robot;
use crate::oracle::{Params, Reference, robot};

/// Longest interval of the quadrature of x and y \[s\]: Simpson's rule is then good to 1e-15 for turns below 10 rad/s.
const QUADRATURE_STEP: f64 = 1e-3;

/// Posture and velocities of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Posture, heading not wrapped.
    pub q: Vector3<f64>,
    /// (v, w).
    pub twist: Vector2<f64>,
}

impl Robot for Body {
    type Build = Params;
    type Held = Vector2<f64>;

    /// Under a constant (τ₁, τ₂): exact in v, w, θ, by Simpson's rule in x and y.
    fn after(&self, p: &Params, tau: &Vector2<f64>, dt: f64) -> Self {
        let accel = robot::acceleration(p, tau);
        let twist_at = |t: f64| self.twist + t * accel;
        let heading_at = |t: f64| self.q.z + t * (self.twist.y + t / 2.0 * accel.y);
        Self {
            q: quadrature(&self.q, dt, twist_at, heading_at),
            twist: twist_at(dt),
        }
    }
}

/// The posture of the reference, carried along in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingReference {
    /// Posture (x_r, y_r, θ_r).
    pub q: Vector3<f64>,
    t: f64,
}

impl MovingReference {
    /// At t = 0.
    pub fn start(reference: &Reference) -> Self {
        Self {
            q: Vector3::from(reference.q0),
            t: 0.0,
        }
    }

    /// Moves on to `t`.
    pub fn move_to(&mut self, reference: &Reference, t: f64) {
        let from = self.t;
        let twist_at = |elapsed: f64| reference.twist(from + elapsed);
        let heading_at = |elapsed: f64| reference.heading(from + elapsed);
        self.q = quadrature(&self.q, t - from, twist_at, heading_at);
        self.t = t;
    }
}

/// Eq. (1) over `dt` with (v, w) and θ given in time.
fn quadrature(
    q: &Vector3<f64>,
    dt: f64,
    twist_at: impl Fn(f64) -> Vector2<f64>,
    heading_at: impl Fn(f64) -> f64,
) -> Vector3<f64> {
    let velocity = |t: f64| {
        let (sine, cosine) = heading_at(t).sin_cos();
        twist_at(t).x * Vector2::new(cosine, sine)
    };
    let steps = (dt / QUADRATURE_STEP).ceil().max(1.0);
    let h = dt / steps;
    let mut place = q.xy();
    for i in 0..steps as usize {
        let t = i as f64 * h;
        place += h / 6.0 * (velocity(t) + 4.0 * velocity(t + h / 2.0) + velocity(t + h));
    }
    Vector3::new(place.x, place.y, heading_at(dt))
}
