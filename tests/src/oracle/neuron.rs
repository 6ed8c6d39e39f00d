//! The shunting neuron.

use nalgebra::SVector;

use super::Params;

/// S⁺(x) = max(0, x), Eq. (5).
pub fn s_plus(x: f64) -> f64 {
    x.max(0.0)
}

/// S⁻(x) = max(0, -x), Eq. (5).
pub fn s_minus(x: f64) -> f64 {
    (-x).max(0.0)
}

/// Rate of one neuron, Eq. (4): dξ/dt = -A ξ + (B - ξ) S⁺(u) - (D + ξ) S⁻(u).
pub fn rate(p: &Params, xi: f64, u: f64) -> f64 {
    -p.a * xi + (p.b - xi) * s_plus(u) - (p.d + xi) * s_minus(u)
}

/// Exact solution of Eq. (4) after `h` seconds with the input held.
///
/// For a held u the equation is linear: ξ goes to ξ∞ = (B S⁺ - D S⁻) / (A + |u|) at the rate A + |u|.
pub fn held(p: &Params, xi: f64, u: f64, h: f64) -> f64 {
    let decay = p.a + u.abs();
    let settled = (p.b * s_plus(u) - p.d * s_minus(u)) / decay;
    settled + (xi - settled) * (-h * decay).exp()
}

/// [`rate`] of several neurons, as in Eq. (17) and Eq. (22).
pub fn rates<const N: usize>(
    p: &Params,
    xi: &SVector<f64, N>,
    u: &SVector<f64, N>,
) -> SVector<f64, N> {
    xi.zip_map(u, |xi, u| rate(p, xi, u))
}

/// [`held`] of several neurons.
pub fn held_all<const N: usize>(
    p: &Params,
    xi: &SVector<f64, N>,
    u: &SVector<f64, N>,
    h: f64,
) -> SVector<f64, N> {
    xi.zip_map(u, |xi, u| held(p, xi, u, h))
}
