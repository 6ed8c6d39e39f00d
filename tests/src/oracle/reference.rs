//! The reference robot: velocities given in time, posture by integration.

use nalgebra::{Vector2, Vector3};
use serde::Deserialize;

use super::robot;

/// Longest interval of the quadrature of [`Reference::posture`] \[s\].
const QUADRATURE_STEP: f64 = 1e-3;

/// Reference with v_r = v0 + v1 sin(Ov t + pv) and w_r = w0 + w1 sin(Ow t + pw).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Reference {
    /// Posture (x_r, y_r, θ_r) at t = 0 \[m, m, rad\].
    pub q0: [f64; 3],
    /// Mean of v_r \[m/s\].
    pub v0: f64,
    /// Amplitude of v_r \[m/s\].
    pub v1: f64,
    /// Angular frequency of v_r \[rad/s\].
    #[serde(rename = "Ov")]
    pub omega_v: f64,
    /// Phase of v_r \[rad\].
    #[serde(rename = "pv")]
    pub phase_v: f64,
    /// Mean of w_r \[rad/s\].
    pub w0: f64,
    /// Amplitude of w_r \[rad/s\].
    pub w1: f64,
    /// Angular frequency of w_r \[rad/s\].
    #[serde(rename = "Ow")]
    pub omega_w: f64,
    /// Phase of w_r \[rad\].
    #[serde(rename = "pw")]
    pub phase_w: f64,
}

impl Reference {
    /// Constant velocities: a line (w_r = 0) or a circle.
    pub fn steady(q0: [f64; 3], v_r: f64, w_r: f64) -> Self {
        Self {
            q0,
            v0: v_r,
            v1: 0.0,
            omega_v: 1.0,
            phase_v: 0.0,
            w0: w_r,
            w1: 0.0,
            omega_w: 1.0,
            phase_w: 0.0,
        }
    }

    /// (v_r, w_r) at `t`.
    pub fn twist(&self, t: f64) -> Vector2<f64> {
        Vector2::new(
            self.v0 + self.v1 * (self.omega_v * t + self.phase_v).sin(),
            self.w0 + self.w1 * (self.omega_w * t + self.phase_w).sin(),
        )
    }

    /// d/dt of (v_r, w_r) at `t`.
    pub fn accel(&self, t: f64) -> Vector2<f64> {
        Vector2::new(
            self.v1 * self.omega_v * (self.omega_v * t + self.phase_v).cos(),
            self.w1 * self.omega_w * (self.omega_w * t + self.phase_w).cos(),
        )
    }

    /// Rate of the reference posture, Eq. (6): the kinematics of Eq. (1) at (v_r, w_r).
    pub fn posture_rate(&self, t: f64, q_r: &Vector3<f64>) -> Vector3<f64> {
        robot::posture_rate(q_r, &self.twist(t))
    }

    /// θ_r at `t`, not wrapped: the third line of Eq. (6) in closed form.
    pub fn heading(&self, t: f64) -> f64 {
        let swing = if self.omega_w == 0.0 {
            self.phase_w.sin() * t
        } else {
            (self.phase_w.cos() - (self.omega_w * t + self.phase_w).cos()) / self.omega_w
        };
        self.q0[2] + self.w0 * t + self.w1 * swing
    }

    /// Posture at `t`: Eq. (6) with the closed heading and Simpson's rule for the position.
    pub fn posture(&self, t: f64) -> Vector3<f64> {
        let intervals = (t.abs() / QUADRATURE_STEP).ceil().max(1.0);
        let h = t / intervals;
        let velocity = |t: f64| {
            let q_r = Vector3::new(0.0, 0.0, self.heading(t));
            self.posture_rate(t, &q_r)
        };
        let mut q_r = Vector3::from(self.q0);
        for i in 0..intervals as usize {
            let start = i as f64 * h;
            q_r +=
                h / 6.0 * (velocity(start) + 4.0 * velocity(start + h / 2.0) + velocity(start + h));
        }
        q_r.z = self.heading(t);
        q_r
    }
}
