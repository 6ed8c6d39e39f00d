//! From velocity error and acceleration to a wrench. Eqs. (11), (12), (14), (16), (21).

use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist, Wrench};

/// Force and moment. One formula serves five equations of the paper. Eqs. (11) and (12) with
/// `accel` = (v̇_c, ẇ_c), Eq. (14) the same with the parking gains, Eqs. (16) and (21) with the
/// neurons' (v̇_s, ẇ_s).
///
/// ```text
/// τ₁ = −k_d1 (v − v_c) + m v̇_s
/// τ₂ = −k_d2 (w − w_c) + I ẇ_s
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | k_d1, k_d2 (k_c1, k_c2) | `gain` | N s/m, N m s |
/// | v − v_c, w − w_c | `velocity_error` | m/s, rad/s |
/// | v̇_s, ẇ_s (v̇_c, ẇ_c) | `accel` | m/s², rad/s² |
/// | m, I | `robot` | kg, kg m² |
#[inline(always)]
pub fn wrench<T: Scalar>(
    robot: &Robot<T>,
    gain: (T, T),
    velocity_error: &Twist<T>,
    accel: &Accel<T>,
) -> Wrench<T> {
    Wrench {
        force: robot.mass_kg * accel.linear - gain.0 * velocity_error.linear,
        moment: robot.inertia_kg_m2 * accel.angular - gain.1 * velocity_error.angular,
    }
}
