//! Principal value of an angle.

use super::reduce::{times_pi, turns};
use super::{INFINITY_BITS, SIGN};
use core::f32::consts::{FRAC_1_PI, PI};

/// Above, and where rounding leaves the range, reduction is done in integers.
const LARGE: f32 = 1e4;

/// 1.5·2²³: adding it rounds to an integer of either sign.
const ROUND: f32 = 12_582_912.0;

/// 2π in three parts (Cody and Waite) of 8, 11 and 24 bits. With n ≤ 1592 the first two products
/// and differences are exact, so reduction costs a single rounding, that of the last difference.
const TAU_PARTS: [f32; 3] = [6.281_25, 1.935_005_2e-3, 3.019_916e-7];

/// The angle equal to `x` rad up to whole turns, in (−π, π].
///
/// Right for any finite `x`, in bounded time: an `x` already inside is returned bit for bit,
/// anything else is within half an ulp of the result plus 4e-9 rad (1.3e-7 in all). The limits are
/// those of `f32`: −[`PI`] becomes [`PI`], and no result is at or below the one or above the
/// other. NaN and infinities give NaN.
#[inline(always)]
pub fn wrap(x: f32) -> f32 {
    if x.abs() < PI {
        return x;
    }
    outside(x)
}

#[inline(never)]
fn outside(x: f32) -> f32 {
    let n = x * (0.5 * FRAC_1_PI) + ROUND - ROUND;
    let [p1, p2, p3] = TAU_PARTS;
    let r = x - n * p1 - n * p2 - n * p3;
    let near = f32::from_bits(x.to_bits() & !SIGN) <= LARGE;
    if near && r > -PI && r < PI {
        r
    } else {
        reduce(x.to_bits())
    }
}

/// `wrap` of the angle with these bits, which is at least π in magnitude or not finite.
#[cold]
#[inline(never)]
fn reduce(bits: u32) -> f32 {
    let mag = bits & !SIGN;
    if mag >= INFINITY_BITS {
        return f32::NAN;
    }
    if mag == PI.to_bits() {
        return PI;
    }
    // Read as signed, the fraction of a turn lies in [−1/2, 1/2).
    let fraction = (turns(mag) >> 32) as u32 as i32;
    const UNIT: f32 = 1.0 / 536_870_912.0;
    let magnitude = times_pi(fraction) * UNIT;
    let wrapped = f32::from_bits(magnitude.to_bits() ^ (bits & SIGN));
    if wrapped > -PI { wrapped } else { PI }
}
