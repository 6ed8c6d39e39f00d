//! The state that is integrated, one row of a trace, and the trace.

use nalgebra::{Vector2, Vector3};

use super::Command;

/// Everything that is integrated; also used for its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Posture of the robot.
    pub q: Vector3<f64>,
    /// (v, w) of the robot.
    pub twist: Vector2<f64>,
    /// Neurons (s₁, s₂, s₃); the one that the phase does not use is 0.
    pub s: Vector3<f64>,
    /// Acceleration neurons (v̇_s, ẇ_s).
    pub accel: Vector2<f64>,
    /// Posture of the reference.
    pub q_r: Vector3<f64>,
}

impl State {
    /// self + h · rate.
    pub fn along(&self, rate: &State, h: f64) -> State {
        State {
            q: self.q + h * rate.q,
            twist: self.twist + h * rate.twist,
            s: self.s + h * rate.s,
            accel: self.accel + h * rate.accel,
            q_r: self.q_r + h * rate.q_r,
        }
    }
}

/// Every signal at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OracleRow {
    /// Time \[s\].
    pub t: f64,
    /// Posture of the robot \[m, m, rad\], heading not wrapped.
    pub q: Vector3<f64>,
    /// (v, w) \[m/s, rad/s\].
    pub twist: Vector2<f64>,
    /// Posture error, Eq. (8).
    pub e: Vector3<f64>,
    /// Neurons (s₁, s₂, s₃).
    pub s: Vector3<f64>,
    /// Rates of the neurons \[1/s\].
    pub s_rate: Vector3<f64>,
    /// Acceleration neurons (v̇_s, ẇ_s).
    pub accel: Vector2<f64>,
    /// Velocity command and its rate.
    pub command: Command,
    /// (τ₁, τ₂) \[N, N m\].
    pub tau: Vector2<f64>,
}

impl OracleRow {
    /// Velocity error δ = (v, w) - (v_c, w_c).
    pub fn delta(&self) -> Vector2<f64> {
        self.twist - self.command.velocity
    }

    /// The golden files' columns; the oracle has no transition offsets, so the last two are 0.
    pub fn columns(&self) -> [f64; 20] {
        let (q, e, s, c) = (&self.q, &self.e, &self.s, &self.command.velocity);
        let (twist, accel, tau) = (&self.twist, &self.accel, &self.tau);
        #[rustfmt::skip]
        let columns = [
            self.t, q.x, q.y, q.z, twist.x, twist.y, e.x, e.y, e.z, s.x, s.y, s.z,
            accel.x, accel.y, c.x, c.y, tau.x, tau.y, 0.0, 0.0,
        ];
        columns
    }
}

/// Rows of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Rows in time order.
    pub rows: Vec<OracleRow>,
    /// The rows just before and just after the switch.
    pub switch: Option<(OracleRow, OracleRow)>,
}

impl Trace {
    /// Instant from which |e| stays below `band` until the switch \[s\]; `None` if it never does.
    pub fn settling_time(&self, band: f64) -> Option<f64> {
        let end = self.switch.map_or(f64::INFINITY, |(before, _)| before.t);
        let tracking: Vec<&OracleRow> = self.rows.iter().filter(|row| row.t < end).collect();
        match tracking.iter().rposition(|row| row.e.norm() >= band) {
            None => tracking.first().map(|row| row.t),
            Some(last_outside) => tracking.get(last_outside + 1).map(|row| row.t),
        }
    }

    /// (τ₁, τ₂) just after the switch less those just before it.
    pub fn torque_jump(&self) -> Option<Vector2<f64>> {
        self.switch.map(|(before, after)| after.tau - before.tau)
    }
}
