//! Principal value of an angle in double precision; [`crate::single::wrap`] is that in single precision.

/// The angle congruent to `angle` in (−π, π]: a two-part 2π near zero, the C library's exact reduction far away.
#[inline]
pub(super) fn wrap_f64(angle: f64) -> f64 {
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
