//! Arguments to try, and the true principal value of an angle too large for std.

use std::f64::consts::TAU;

/// Largest `error` over the floats from `first` to `last` (of one sign), every `step`-th of them;
/// NaN counts as infinite.
pub fn worst(first: f32, last: f32, step: u32, error: impl Fn(f32) -> f64 + Sync) -> f64 {
    const THREADS: u32 = 2;
    let (first, last) = (first.to_bits(), last.to_bits());
    let share = |thread: u32| {
        let (mut max, mut at) = (0.0, first);
        let mut bits = first + thread * step;
        while bits <= last {
            let e = error(f32::from_bits(bits));
            if e > max || e.is_nan() {
                (max, at) = (if e.is_nan() { f64::INFINITY } else { e }, bits);
            }
            bits += THREADS * step;
        }
        (max, f32::from_bits(at))
    };
    let (max, at) = std::thread::scope(|scope| {
        let other = scope.spawn(|| share(1));
        let (mine, other) = (share(0), other.join().unwrap());
        if mine.0 > other.0 { mine } else { other }
    });
    println!("largest error {max:.3e} at {at:e}");
    max
}

/// 1/(2π) to 256 binary digits after the point, by long division by the digits of π.
pub fn turns_per_radian() -> [u32; 8] {
    // 2π in units of 2⁻²⁵², in two halves, and the remainder, starting from 1.
    const HIGH: u128 = 0x6487_ed51_10b4_611a_6263_3145_c06e_0e68;
    const LOW: u128 = 0x9481_2704_4533_e63a_0105_df53_1d89_cd91;
    let (mut high, mut low) = (1_u128 << 124, 0_u128);
    std::array::from_fn(|_| {
        (0..32).fold(0, |digits, _| {
            (high, low) = ((high << 1) | (low >> 127), low << 1);
            let fits = (high, low) >= (HIGH, LOW);
            if fits {
                let (rest, borrow) = low.overflowing_sub(LOW);
                (high, low) = (high - HIGH - u128::from(borrow), rest);
            }
            (digits << 1) | u32::from(fits)
        })
    })
}

/// The angle equal to a normal `x` up to whole turns, in [−π, π].
pub fn principal(x: f32, turns_per_radian: &[u32; 8]) -> f64 {
    let mantissa = u128::from((x.to_bits() & 0x007f_ffff) | 0x0080_0000);
    let exponent = ((x.to_bits() >> 23) & 0xff) as i32 - 150;
    // |x| is mantissa·2^exponent: 128 digits, from the one that weighs 2^(−1 − exponent) on.
    let (first, shift) = (exponent.div_euclid(32), exponent.rem_euclid(32));
    let word = |i| u128::from(usize::try_from(first + i).map_or(0, |i| turns_per_radian[i]));
    let high = (0..4).fold(0, |digits, i| (digits << 32) | word(i));
    let turns = (high << shift) | (word(4) >> (32 - shift));
    let fraction = mantissa.wrapping_mul(turns) as i128 as f64 / 2_f64.powi(128);
    fraction * TAU * f64::from(x.signum())
}
