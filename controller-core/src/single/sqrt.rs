//! Square root, and one over it.

use super::INFINITY_BITS;

/// Bits of the smallest normal number.
const NORMAL: u32 = 0x0080_0000;

/// Square root of `x`, correctly rounded: the bits of the IEEE 754 operation.
///
/// Stable `core` has no square root yet. Two Newton steps for 1/√x from a guess of its exponent,
/// one for √x, and a last unit settled in integers. Negative arguments and NaN give NaN; −0 gives
/// −0.
#[inline]
pub fn sqrt(x: f32) -> f32 {
    let bits = x.to_bits();
    if is_special(bits) {
        return special(x);
    }
    root(bits)
}

/// 1/√`x`, within 1.4e-7 of it, in half the work of a root and a division.
///
/// Infinities, zeros, negative arguments and NaN as with these.
#[inline]
pub fn inverse_sqrt(x: f32) -> f32 {
    let bits = x.to_bits();
    if is_special(bits) {
        return special_inverse(x);
    }
    let half = 0.5 * x;
    let y = inverse_guess(bits, half);
    y + y * (0.5 - half * y * y)
}

/// Not a positive normal number.
#[inline]
fn is_special(bits: u32) -> bool {
    bits.wrapping_sub(NORMAL) >= INFINITY_BITS - NORMAL
}

/// 1/√x within 4.8e-6 of it, of a positive normal number, half of which is `half`.
#[inline]
fn inverse_guess(bits: u32, half: f32) -> f32 {
    // Halving and negating the bits does so to the logarithm, up to the curve of the mantissa; the
    // constant balances the error of the guess, 3.5e-2. Then 1.8e-3, 4.8e-6.
    let y = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(bits >> 1));
    let y = y * (1.5 - half * y * y);
    y * (1.5 - half * y * y)
}

/// The root of a positive normal number.
fn root(bits: u32) -> f32 {
    let x = f32::from_bits(bits);
    let y = inverse_guess(bits, 0.5 * x);
    let s = x * y;
    let s = s + 0.5 * y * (x - s * s);

    // s is now at most one unit off. With the mantissas m of x and q of s as integers, √m lies
    // within half a unit of q exactly if −q < m·2^shift − q² ≤ q; 32 bits hold that difference.
    let estimate = s.to_bits();
    let m = (bits & 0x007f_ffff) | NORMAL;
    let q = (estimate & 0x007f_ffff) | NORMAL;
    let shift = (bits >> 23)
        .wrapping_add(150)
        .wrapping_sub((estimate >> 23) << 1);
    let rest = m.wrapping_shl(shift).wrapping_sub(q.wrapping_mul(q)) as i32;
    let q = q as i32;
    let up = u32::from(rest > q);
    let down = u32::from(rest <= -q);
    f32::from_bits(estimate.wrapping_add(up).wrapping_sub(down))
}

/// [`inverse_sqrt`] of what [`special`] is for.
#[cold]
#[inline(never)]
fn special_inverse(x: f32) -> f32 {
    1.0 / special(x)
}

/// Zeros, subnormal and negative numbers, infinities and NaN.
#[cold]
#[inline(never)]
fn special(x: f32) -> f32 {
    if x == 0.0 || x.to_bits() == INFINITY_BITS {
        x
    } else if x > 0.0 {
        const UP: f32 = 16_777_216.0;
        const DOWN: f32 = 1.0 / 4096.0;
        root((x * UP).to_bits()) * DOWN
    } else {
        f32::NAN
    }
}
