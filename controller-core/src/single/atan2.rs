//! Angle of a vector.

use super::SIGN;
use core::f32::consts::{FRAC_PI_2, PI};

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
/// Within 2.7e-7 of the true value; the largest error found is 2.5e-7. Zeros, their signs and infinities follow IEEE 754: the result
/// has the sign of `y`, so that `atan2(0, 0)` is 0 and `atan2(0, −0)` is π. NaN gives NaN.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (x_bits, sign) = (x.to_bits(), y.to_bits() & SIGN);
    let abs_y = y.to_bits() & !SIGN;
    // The angle of (x, |y|) is atan(|y|/x) from the near end of the x axis, or atan(−x/|y|) from
    // the y axis.
    let (num, den, base) = if abs_y > x_bits & !SIGN {
        (x_bits ^ SIGN, abs_y, FRAC_PI_2.to_bits())
    } else {
        (abs_y, x_bits, PI.to_bits() & ((x_bits as i32) >> 31) as u32)
    };
    let base = f32::from_bits(base);
    let ratio = f32::from_bits(num) / f32::from_bits(den);
    let q = if ratio.is_nan() { limit(y, x) } else { ratio };
    let z = q * q;
    let p = A[0] + z * (A[1] + z * (A[2] + z * (A[3] + z * (A[4] + z * (A[5] + z * A[6])))));
    let angle = base + (q + q * z * p + base * PI_REST);
    f32::from_bits(angle.to_bits() ^ sign)
}

/// What stands for the ratio |y|/x where it is 0/0, ∞/∞ or of a NaN.
#[cold]
#[inline(never)]
fn limit(y: f32, x: f32) -> f32 {
    if x.is_nan() || y.is_nan() {
        f32::NAN
    } else if x.to_bits() & !SIGN == 0 {
        0.0
    } else {
        f32::from_bits(1.0_f32.to_bits() | (x.to_bits() & SIGN))
    }
}
