//! Principal value of an angle.

use super::reduce::{times_pi, turns};
use super::{INFINITY_BITS, SIGN};
use core::f32::consts::PI;

/// The angle equal to `x` rad up to whole turns, in (−π, π].
///
/// Right for any finite `x`, in bounded time: an `x` already inside is returned bit for bit,
/// anything else is reduced exactly, within half an ulp of the result plus 4e-9 rad (1.3e-7 in
/// all). The limits are those of `f32`: −[`PI`] becomes [`PI`], and no result is at or below the
/// one or above the other. NaN and infinities give NaN.
#[inline]
pub fn wrap(x: f32) -> f32 {
    if x > -PI && x <= PI {
        x
    } else {
        reduce(x.to_bits())
    }
}

/// `wrap` of the angle with these bits, which is at least π in magnitude or not finite.
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
