//! Angles on the circle.
//!
//! Tracking sees a heading error only through its sine and cosine, so it needs no wrap. Parking
//! by Eq. (22) feeds the error itself to a neuron: one turn too much would spin the robot once
//! around, so that error is wrapped.

use crate::scalar::Scalar;

/// The angle congruent to `angle` modulo 2π in (−π, π].
///
/// | | |
/// | --- | --- |
/// | `angle` | rad, any finite value |
/// | result | rad, in (−π, π]; −π itself becomes π |
/// | error | `f64`: 1 unit in the last place of the argument's own resolution up to 1e5 rad, 1e-15 rad beyond; `f32`: 4e-7 rad over all finite values |
/// | cost | bounded: one comparison inside (−π, π], one rounding up to 1e5 (`f64`) or 1e4 rad (`f32`), an exact large-argument reduction beyond |
///
/// Angles inside (−π, π] come back unchanged, bit for bit. A NaN or infinite angle gives NaN.
///
/// ```
/// use controller_core::angle::wrap;
/// assert_eq!(wrap(0.5_f64), 0.5);
/// assert!((wrap(7.0_f64) - (7.0 - core::f64::consts::TAU)).abs() < 1e-15);
/// ```
#[inline]
pub fn wrap<T: Scalar>(angle: T) -> T {
    angle.wrap_angle()
}
