//! Exact reduction of large angles, after Payne and Hanek (1983).

/// Binary digits of 2/π after a word of zeros: bit `i`, counted from the left, weighs 2^(31 − i).
///
/// Words 0 to 6 can be reached; the last three only make the bound of the index visible.
const TWO_OVER_PI: [u32; 10] = [
    0x0000_0000,
    0xa2f9_836e,
    0x4e44_1529,
    0xfc27_57d1,
    0xf534_ddc0,
    0xdb62_9599,
    0x3c43_9041,
    0xfe51_63ab,
    0xdebb_c561,
    0xb724_6e3a,
];

/// π in units of 2⁻²⁹, which is also π/2 in units of 2⁻³⁰.
const PI_Q29: i64 = 0x6487_ed51;

/// Turns in the angle of magnitude `mag` (bits of a finite `f32` ≥ 2⁻⁷), modulo 1, in units of 2⁻⁶⁴.
///
/// The angle is m·2^e with m < 2²⁴, and a turn is four quadrants of π/2. Digits of 2/π that weigh
/// 2^(2 − e) or more contribute whole turns and are left out; the next 64 are kept; those after
/// them amount to less than 2^(−62 − e), so that the product with m is short by less than 2²⁴
/// units (6e-12 rad). The product modulo 2⁶⁴ is the fraction of the turn.
#[inline]
pub(super) fn turns(mag: u32) -> u64 {
    let m = (mag & 0x007f_ffff) | 0x0080_0000;
    // e = exponent field − 150; the first digit kept weighs 2^(1 − e) and is digit number 30 + e.
    let first = (mag >> 23).wrapping_sub(120);
    let word = ((first >> 5) & 7) as usize;
    let shift = first & 31;
    let join = |high: u32, low: u32| (high << shift) | ((low >> 1) >> (31 - shift));
    let (a, b, c) = (
        TWO_OVER_PI[word],
        TWO_OVER_PI[word + 1],
        TWO_OVER_PI[word + 2],
    );
    let digits = (u64::from(join(a, b)) << 32) | u64::from(join(b, c));
    digits.wrapping_mul(u64::from(m))
}

/// `fraction` times π, in units of 2⁻²⁸ of `fraction`'s own; short by less than one unit.
///
/// A fraction of a turn in units of 2⁻³² becomes an angle in units of 2⁻²⁹ rad, a fraction of a
/// quadrant one in units of 2⁻³¹ rad. Rounding happens once, in the conversion to `f32`.
#[inline]
pub(super) fn times_pi(fraction: i32) -> f32 {
    ((i64::from(fraction) * PI_Q29) >> 31) as i32 as f32
}
