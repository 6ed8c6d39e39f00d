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

/// [`wrap`] for doubles: a two-part 2π near zero, the C library's exact reduction far away.
#[inline]
pub(crate) fn wrap_f64(angle: f64) -> f64 {
    use core::f64::consts::PI;
    /// 2π as a double and what that double leaves out, so that k·2π keeps its low bits for the
    /// |k| < 2^15 of the fast path. 2π has its last 19 bits cut: k·TAU_HIGH is then exact.
    const TAU_HIGH: f64 = f64::from_bits(core::f64::consts::TAU.to_bits() & !0x7_FFFF);
    const TAU_MID: f64 = core::f64::consts::TAU - TAU_HIGH;
    /// 2π − TAU = 2.449e-16: twice the well-known tail of π (1.2246467991473532e-16).
    const TAU_LOW: f64 = 2.449_293_598_294_706_4e-16;
    if angle > -PI && angle <= PI {
        return angle;
    }
    let wrapped = if angle.abs() < 1.0e5 {
        // Adding and subtracting 1.5·2^52 rounds to the nearest integer without a library call.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let turns = (angle * (1.0 / core::f64::consts::TAU) + ROUND) - ROUND;
        ((angle - turns * TAU_HIGH) - turns * TAU_MID) - turns * TAU_LOW
    } else {
        // The library reduces any finite double exactly; rare and slow (microseconds), but right.
        let (sine, cosine) = libm::sincos(angle);
        libm::atan2(sine, cosine)
    };
    into_half_open(wrapped, PI)
}

/// [`wrap`] for singles; see [`crate::maths::single`].
#[inline]
pub(crate) fn wrap_f32(angle: f32) -> f32 {
    crate::maths::single::wrap(angle)
}

/// Rounding may land a hair outside the circle, or on −π, which is named π.
#[inline]
fn into_half_open(angle: f64, pi: f64) -> f64 {
    if angle > -pi {
        if angle > pi { pi } else { angle }
    } else if angle.is_nan() {
        angle
    } else {
        pi
    }
}
