//! Velocity commands with their analytic rates, and the torque law.
//!
//! The rates depend on the state only, never on the torque, so there is no algebraic loop.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::Params;

/// Commanded velocities and their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// (v_c, w_c) \[m/s, rad/s\].
    pub velocity: Vector2<f64>,
    /// (v_c', w_c') \[m/s², rad/s²\].
    pub rate: Vector2<f64>,
}

/// What the reference does at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// (v_r, w_r) \[m/s, rad/s\].
    pub twist: Vector2<f64>,
    /// (v_r', w_r') \[m/s², rad/s²\].
    pub accel: Vector2<f64>,
}

/// Plain backstepping while tracking, Eq. (10), from the error and its rate.
pub fn plain_tracking(
    p: &Params,
    target: &Target,
    e: &Vector3<f64>,
    e_rate: &Vector3<f64>,
) -> Command {
    let (v_r, w_r) = (target.twist.x, target.twist.y);
    let (v_r_rate, w_r_rate) = (target.accel.x, target.accel.y);
    Command {
        velocity: Vector2::new(
            p.k1 * e.x + v_r * e.z.cos(),
            w_r + p.k2 * e.y * v_r + p.k3 * e.z.sin(),
        ),
        rate: Vector2::new(
            p.k1 * e_rate.x + v_r_rate * e.z.cos() - v_r * e.z.sin() * e_rate.z,
            w_r_rate + p.k2 * (e_rate.y * v_r + e.y * v_r_rate) + p.k3 * e.z.cos() * e_rate.z,
        ),
    }
}

/// Plain backstepping while parking, Eq. (13).
pub fn plain_parking(p: &Params, e: &Vector3<f64>, e_rate: &Vector3<f64>) -> Command {
    Command {
        velocity: Vector2::new(p.k4 * e.x, p.k5 * e.z.sin()),
        rate: Vector2::new(p.k4 * e_rate.x, p.k5 * e.z.cos() * e_rate.z),
    }
}

/// Neural tracking, Eq. (15): e_x and e_y of Eq. (10) replaced by the neurons s₁ and s₂ of Eq. (17).
pub fn neural_tracking(
    p: &Params,
    target: &Target,
    e: &Vector3<f64>,
    e_rate: &Vector3<f64>,
    s: &Vector3<f64>,
    s_rate: &Vector3<f64>,
) -> Command {
    plain_tracking(
        p,
        target,
        &Vector3::new(s.x, s.y, e.z),
        &Vector3::new(s_rate.x, s_rate.y, e_rate.z),
    )
}

/// Neural parking, Eq. (20): e_x and e_θ of Eq. (13) replaced by the neurons s₁ and s₃ of Eq. (22).
pub fn neural_parking(p: &Params, s: &Vector3<f64>, s_rate: &Vector3<f64>) -> Command {
    plain_parking(p, s, s_rate)
}

/// τ = -k δ + M̄ a with δ = (v, w) - (v_c, w_c).
///
/// With a the command's rate this is Eq. (12) and Eq. (14), with a the acceleration neurons Eq. (16) and Eq. (21).
pub fn torque(
    p: &Params,
    gain: &Matrix2<f64>,
    delta: &Vector2<f64>,
    accel: &Vector2<f64>,
) -> Vector2<f64> {
    -gain * delta + p.mass_matrix() * accel
}

/// (s₁(0), s₂(0), 0) that start the command at the robot's own velocity.
///
/// Eq. (18) is the case v(0) = w(0) = 0. Divides by v_r(0): the reference must move at the start.
pub fn initial_neurons(
    p: &Params,
    target: &Target,
    e: &Vector3<f64>,
    twist: &Vector2<f64>,
) -> Vector3<f64> {
    let (v_r, w_r) = (target.twist.x, target.twist.y);
    assert!(v_r != 0.0, "Eq. (18) divides by v_r(0), which is zero");
    Vector3::new(
        (twist.x - v_r * e.z.cos()) / p.k1,
        (twist.y - w_r - p.k3 * e.z.sin()) / (p.k2 * v_r),
        0.0,
    )
}
