//! The robot: kinematics, dynamics and the wheel torque map.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};

use super::Params;

/// S(q) of Eq. (1).
pub fn velocity_map(q: &Vector3<f64>) -> Matrix3x2<f64> {
    let (s, c) = q.z.sin_cos();
    #[rustfmt::skip]
    let map = Matrix3x2::new(
          c, 0.0,
          s, 0.0,
        0.0, 1.0,
    );
    map
}

/// q' = S(q) (v, w), Eq. (1).
pub fn posture_rate(q: &Vector3<f64>, twist: &Vector2<f64>) -> Vector3<f64> {
    velocity_map(q) * twist
}

/// (v', w') = M̄⁻¹ (τ₁, τ₂), Eq. (3); τ₁ is a force \[N\], τ₂ a moment \[N m\].
pub fn acceleration(p: &Params, tau: &Vector2<f64>) -> Vector2<f64> {
    inverse(&p.mass_matrix()) * tau
}

/// B̄ that takes wheel torques (right, left) to (force, moment), corrected under Eq. (3).
///
/// By virtual work with v = r (φ_R' + φ_L')/2 and w = r (φ_R' - φ_L')/l: B̄ = 1/r \[1, 1; l/2, -l/2\].
pub fn wheel_map(p: &Params) -> Matrix2<f64> {
    Matrix2::new(1.0, 1.0, p.l / 2.0, -p.l / 2.0) / p.r
}

/// B̄ as the paper prints it under Eq. (3): 1/r \[1, 0; l, -l\]. Wrong: the left wheel would not push.
pub fn wheel_map_printed(p: &Params) -> Matrix2<f64> {
    Matrix2::new(1.0, 0.0, p.l, -p.l) / p.r
}

/// What (force, moment) the true robot feels when (τ₁, τ₂) is shared to the wheels by the printed B̄.
pub fn printed_effort(p: &Params) -> Matrix2<f64> {
    wheel_map(p) * inverse(&wheel_map_printed(p))
}

/// Inverse of a matrix that is regular for every robot with m, I, r, l > 0.
pub fn inverse(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    matrix
        .try_inverse()
        .expect("m, I, r and l of the robot are positive")
}
