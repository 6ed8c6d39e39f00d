//! Angle of a vector.

use super::{INFINITY_BITS, SIGN};
use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// atan q ≈ q + q³(A0 + A1 q² + … + A6 q¹²), absolute minimax on |q| ≤ 1: 5.0e-8.
const A: [f32; 7] = [
    -0.333_316_6,
    0.199_627_09,
    -0.139_766_02,
    0.097_942_76,
    -0.057_774_026,
    0.023_040_352,
    -0.004_355_443_6,
];

/// What π lacks in `f32`, as a fraction of it; π/2 lacks the same fraction.
const PI_REST: f32 = -2.782_753_5e-8;

/// Angle of the vector (`x`, `y`) from the x axis, in [−π, π] rad.
///
/// Within 2.4e-7 of the true value. Zeros, their signs and infinities follow IEEE 754: the result
/// has the sign of `y`, so that `atan2(0, 0)` is 0 and `atan2(0, −0)` is π. NaN gives NaN.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let abs_x = f32::from_bits(x.to_bits() & !SIGN);
    let abs_y = f32::from_bits(y.to_bits() & !SIGN);
    // The angle of (x, |y|) is atan(|y|/x) from the near end of the x axis, or atan(−x/|y|) from
    // the y axis.
    let (num, den, base) = if abs_y > abs_x {
        (-x, abs_y, FRAC_PI_2)
    } else {
        (abs_y, x, if x < 0.0 { PI } else { 0.0 })
    };
    let q = num / den;
    if q.is_nan() {
        return without_ratio(y, x);
    }
    let z = q * q;
    let p = A[0] + z * (A[1] + z * (A[2] + z * (A[3] + z * (A[4] + z * (A[5] + z * A[6])))));
    let angle = base + (q + (q * z * p + base * PI_REST));
    f32::from_bits(angle.to_bits() ^ (y.to_bits() & SIGN))
}

/// `atan2` where the ratio is 0/0, ∞/∞ or of a NaN.
#[cold]
#[inline(never)]
fn without_ratio(y: f32, x: f32) -> f32 {
    if x.is_nan() || y.is_nan() {
        return f32::NAN;
    }
    let infinite = x.to_bits() & !SIGN == INFINITY_BITS;
    let angle = match (infinite, x.is_sign_negative()) {
        (false, false) => 0.0,
        (false, true) => PI,
        (true, false) => FRAC_PI_4,
        (true, true) => 3.0 * FRAC_PI_4,
    };
    f32::from_bits(angle.to_bits() ^ (y.to_bits() & SIGN))
}
