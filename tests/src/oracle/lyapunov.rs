//! The functions of the paper's stability argument, as printed and corrected.

use nalgebra::{Vector2, Vector3};

use super::neuron::{s_minus, s_plus};
use super::{OracleRow, Params};

/// V₁ under Eq. (24) as printed: (e_x + e_y)²/2 + (1 - cos e_θ)/k₂.
pub fn v1_printed(p: &Params, e: &Vector3<f64>) -> f64 {
    (e.x + e.y).powi(2) / 2.0 + (1.0 - e.z.cos()) / p.k2
}

/// V₁ corrected: (e_x² + e_y²)/2 + (1 - cos e_θ)/k₂.
pub fn v1(p: &Params, e: &Vector3<f64>) -> f64 {
    (e.x.powi(2) + e.y.powi(2)) / 2.0 + (1.0 - e.z.cos()) / p.k2
}

/// V₂ = δᵀ M̄ δ / 2 under Eq. (24).
pub fn v2(p: &Params, delta: &Vector2<f64>) -> f64 {
    delta.dot(&(p.mass_matrix() * delta)) / 2.0
}

/// V_s under Eq. (24): half the sum of squares of all five neurons.
pub fn v_s(s: &Vector3<f64>, accel: &Vector2<f64>) -> f64 {
    (s.norm_squared() + accel.norm_squared()) / 2.0
}

/// V of Eq. (24) with V₁ as printed.
pub fn v_printed(p: &Params, row: &OracleRow) -> f64 {
    v1_printed(p, &row.e) + v2(p, &row.delta()) + v_s(&row.s, &row.accel)
}

/// V of Eq. (24) with V₁ corrected.
pub fn v_corrected(p: &Params, row: &OracleRow) -> f64 {
    v1(p, &row.e) + v2(p, &row.delta()) + v_s(&row.s, &row.accel)
}

/// One neuron's part of dV_s/dt as Eq. (25) prints it: -(A + S⁺(u) + S⁻(u)) s².
pub fn neuron_power_printed(p: &Params, s: f64, u: f64) -> f64 {
    -(p.a + s_plus(u) + s_minus(u)) * s * s
}

/// The part that Eq. (25) leaves out: s (B S⁺(u) - D S⁻(u)).
pub fn neuron_power_dropped(p: &Params, s: f64, u: f64) -> f64 {
    s * (p.b * s_plus(u) - p.d * s_minus(u))
}

/// Storage of the provable statement for a neuron on e_x alone, with e_y direct as in Eq. (10) and B = D:
/// V = V₁ + k₁ s₁²/(2B).
pub fn v_single_neuron(p: &Params, e: &Vector3<f64>, s1: f64) -> f64 {
    v1(p, e) + p.k1 * s1 * s1 / (2.0 * p.b)
}

/// Rate of [`v1`] along a given rate of the error: e_x e_x' + e_y e_y' + sin e_θ e_θ'/k₂.
pub fn v1_rate(p: &Params, e: &Vector3<f64>, e_rate: &Vector3<f64>) -> f64 {
    Vector3::new(e.x, e.y, e.z.sin() / p.k2).dot(e_rate)
}

/// Rate of [`v2`] along a given rate of δ: δᵀ M̄ δ'.
pub fn v2_rate(p: &Params, delta: &Vector2<f64>, delta_rate: &Vector2<f64>) -> f64 {
    delta.dot(&(p.mass_matrix() * delta_rate))
}
