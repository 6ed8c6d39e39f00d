//! Posture error in the frame of the robot.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector2, Vector3};

/// The same angle in (-π, π].
pub fn wrap(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

/// T_e of Eq. (8): world frame to the frame of a robot with heading θ.
pub fn error_frame(theta: f64) -> Matrix3<f64> {
    let (s, c) = theta.sin_cos();
    #[rustfmt::skip]
    let t_e = Matrix3::new(
          c,   s, 0.0,
         -s,   c, 0.0,
        0.0, 0.0, 1.0,
    );
    t_e
}

/// e_p = T_e (q_r - q), Eq. (7) and Eq. (8), with e_θ wrapped to (-π, π] \[m, m, rad\].
pub fn error(q_r: &Vector3<f64>, q: &Vector3<f64>) -> Vector3<f64> {
    let mut e = error_frame(q.z) * (q_r - q);
    e.z = wrap(e.z);
    e
}

/// Rate of the error, Eq. (9), from the robot's (v, w) and the reference's (v_r, w_r).
pub fn error_rate(
    e: &Vector3<f64>,
    twist: &Vector2<f64>,
    reference: &Vector2<f64>,
) -> Vector3<f64> {
    let (v, w) = (twist.x, twist.y);
    let (v_r, w_r) = (reference.x, reference.y);
    Vector3::new(
        w * e.y - v + v_r * e.z.cos(),
        -w * e.x + v_r * e.z.sin(),
        w_r - w,
    )
}
