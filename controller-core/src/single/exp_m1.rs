//! Exponential less one.

use super::SIGN;
use core::f32::consts::LOG2_E;

/// Up to here, just below (ln 2)/2, there is nothing to reduce.
const NEAR: f32 = 0.346;

/// Bits of 17.5: beyond, exp x − 1 is −1 in `f32`, or it may overflow on the way.
const FAR: u32 = 0x418c_0000;

/// 1.5·2²³: adding it rounds to an integer of either sign and leaves it in the low bits.
const ROUND: f32 = 12_582_912.0;

/// ln 2 in two parts, of 15 and 24 bits: n times the first is exact for |n| ≤ 512.
const LN_2_PARTS: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];

/// exp r − 1 ≈ r + r²(E0 + E1 r + … + E4 r⁴), minimax relative to exp r − 1 on |r| ≤ (ln 2)/2:
/// 1.5e-8.
const E: [f32; 5] = [
    0.499_999_97,
    0.166_665_39,
    0.041_667_756,
    0.008_367_124,
    0.001_383_564_1,
];

/// exp(`x`) − 1 without the cancellation near 0.
///
/// Within 1.2e-7 of the true value relative to it (all `x` tried). For `x` ≤ 0, where 1 − exp(−a)
/// is −exp_m1(−a), within 9.1e-8 relative and 6e-8 absolute, and never below −1. +∞ from
/// the overflow of exp on; −∞ gives −1, NaN gives NaN. A zero of either sign gives +0.
pub fn exp_m1(x: f32) -> f32 {
    // A tick times a decay rate: what is left out would change no bit.
    if x.abs() < NEAR {
        return reduced_exp_m1(x);
    }
    let (p, n) = if x.to_bits() & !SIGN <= FAR {
        reduced(x)
    } else {
        (far(x), 0)
    };
    let scale = f32::from_bits(0x3f80_0000_u32.wrapping_add(n << 23));
    scale * p + (scale - 1.0)
}

/// exp r − 1 for r = `x` − n ln 2, |r| ≤ (ln 2)/2, and n in the low 9 bits.
#[inline]
fn reduced(x: f32) -> (f32, u32) {
    let shifted = x * LOG2_E + ROUND;
    let n = shifted - ROUND;
    let [high, low] = LN_2_PARTS;
    let r = x - n * high - n * low;
    (reduced_exp_m1(r), shifted.to_bits())
}

/// exp r − 1 for |r| ≤ (ln 2)/2.
#[inline(always)]
fn reduced_exp_m1(r: f32) -> f32 {
    let p = E[0] + r * (E[1] + r * (E[2] + r * (E[3] + r * E[4])));
    r + r * r * p
}

/// `exp_m1` beyond ±17.5.
#[cold]
#[inline(never)]
fn far(x: f32) -> f32 {
    if x.is_nan() {
        f32::NAN
    } else if x < 0.0 {
        -1.0
    } else if x > 89.0 {
        f32::INFINITY
    } else {
        // Half the value, since 2¹²⁸ has no `f32`.
        let (p, n) = reduced(x);
        let half = f32::from_bits(0x3f00_0000_u32.wrapping_add(n << 23));
        2.0 * (half * p + (half - 0.5))
    }
}
