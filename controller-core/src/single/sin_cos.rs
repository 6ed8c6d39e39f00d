//! Sine and cosine of one angle.

use super::reduce::{times_pi, turns};
use super::{INFINITY_BITS, SIGN};

/// Above, the reduction in floating point gives way to the exact one in integers.
const LARGE: f32 = 1.0e4;

/// 1.5·2²³: adding it rounds to an integer of either sign and leaves that integer in the low bits.
const ROUND: f32 = 12_582_912.0;

/// π in two parts (Cody and Waite) of 12 and 24 bits. With n ≤ 3184 the first product and
/// difference are exact; π happens to lie so close to 3217/1024 that the second product, at most
/// 0.03, is rounded by less than 1e-9. So reduction costs little more than its last rounding.
const PI_PARTS: [f32; 2] = [3.141_601_6, -8.908_91e-6];

/// sin r ≈ r + r³(S0 + S1 r² + S2 r⁴ + S3 r⁶), absolute minimax on |r| ≤ 1.5711 (π/2 and the slack
/// of the rounded quotient): 4.9e-9.
const S: [f32; 4] = [
    -0.166_666_57,
    0.008_333_009,
    -1.980_603_1e-4,
    2.598_852_5e-6,
];

/// cos r ≈ 1 + r²(C0 + C1 r² + C2 r⁴ + C3 r⁶ + C4 r⁸), absolute minimax on the same interval: 4.3e-10.
const C: [f32; 5] = [
    -0.5,
    0.041_666_657,
    -0.001_388_858_5,
    2.477_018e-5,
    -2.620_902e-7,
];

/// Sine and cosine of `x` rad, in this order.
///
/// Both are within 1.2e-7 of the true values for every `x` up to 1e4 in magnitude (all tried) and
/// never outside [−1, 1]; the same bound holds for any finite `x`, in bounded time, by exact
/// reduction. sin(−x) = −sin x and cos(−x) = cos x bit for bit. NaN and infinities give NaN.
#[inline(always)]
pub fn sin_cos(x: f32) -> (f32, f32) {
    if x.abs() <= LARGE {
        sin_cos_near(x)
    } else {
        let (r, half_turns) = reduce_large(x);
        evaluate(r, half_turns)
    }
}

/// [`sin_cos`] for |`x`| ≤ 1e4 rad, unchecked: beyond, the result is wrong.
#[inline(always)]
pub fn sin_cos_near(x: f32) -> (f32, f32) {
    let shifted = x * core::f32::consts::FRAC_1_PI + ROUND;
    let n = shifted - ROUND;
    let [p1, p2] = PI_PARTS;
    evaluate(x - n * p1 - n * p2, shifted.to_bits())
}

/// The polynomials at `r`, the angle less `half_turns` times π; an odd number negates both.
///
/// Multiplying by ±1 is exact, and cheaper on the chip than moving results to integer registers
/// to flip their signs.
#[inline(always)]
fn evaluate(r: f32, half_turns: u32) -> (f32, f32) {
    let sign = f32::from_bits(1.0_f32.to_bits() ^ (half_turns << 31));
    let z = r * r;
    let signed = z * sign;
    let sine = r * sign + r * signed * (S[0] + z * (S[1] + z * (S[2] + z * S[3])));
    let cosine = sign + signed * (C[0] + z * (C[1] + z * (C[2] + z * (C[3] + z * C[4]))));
    (sine, cosine)
}

/// The angle less the nearest multiple of π, and that multiple modulo 2.
#[cold]
#[inline(never)]
fn reduce_large(x: f32) -> (f32, u32) {
    let bits = x.to_bits();
    let mag = bits & !SIGN;
    if mag >= INFINITY_BITS {
        return (f32::NAN, 0);
    }
    let turns = turns(mag);
    // Read as signed, the 32 bits below the half turn count from the nearest multiple.
    let fraction = (turns >> 31) as u32 as i32;
    let half_turns = ((turns >> 62) as u32).wrapping_add(1) >> 1;
    const UNIT: f32 = 1.0 / 1_073_741_824.0;
    let r = times_pi(fraction) * UNIT;
    (f32::from_bits(r.to_bits() ^ (bits & SIGN)), half_turns)
}
