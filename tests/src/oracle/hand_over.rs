//! State of the neurons when tracking hands over to parking.

use nalgebra::{Vector2, Vector3};
use serde::Deserialize;

use super::robot::inverse;
use super::{Command, Params};

/// How the acceleration neurons are set at the switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reset {
    /// Torque is continuous for any k_c.
    Corrected,
    /// The last two lines of Eq. (23) as printed: the neurons take the command's rate.
    Printed,
    /// The neurons start from zero.
    Zero,
}

/// (s₁, s₂, s₃) just after the switch, the first two lines of Eq. (23); s₂ is not used in parking and is 0.
pub fn pose_neurons(p: &Params, before: &Command) -> Vector3<f64> {
    let sine = before.velocity.y / p.k5;
    assert!(
        sine.abs() <= 1.0,
        "Eq. (23) needs |w_c| <= k5 at the switch: w_c / k5 = {sine}"
    );
    Vector3::new(before.velocity.x / p.k4, 0.0, sine.asin())
}

/// (v̇_s, ẇ_s) just after the switch, the last two lines of Eq. (23) or their replacement.
///
/// The corrected rule solves -k_c δ + M̄ a⁺ = -k_d δ + M̄ a⁻ for a⁺, δ being the same on both sides:
/// a⁺ = a⁻ + M̄⁻¹ (k_c - k_d) δ.
pub fn accel_neurons(
    p: &Params,
    reset: Reset,
    before: &Command,
    twist: &Vector2<f64>,
    accel: &Vector2<f64>,
) -> Vector2<f64> {
    let delta = twist - before.velocity;
    match reset {
        Reset::Corrected => {
            accel + inverse(&p.mass_matrix()) * (p.parking_gain() - p.tracking_gain()) * delta
        }
        Reset::Printed => before.rate,
        Reset::Zero => Vector2::zeros(),
    }
}
