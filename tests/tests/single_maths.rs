//! Error bounds of the single-precision functions against double precision, over every argument
//! where that is affordable.
//!
//! std's `f64` functions are good to 1e-15, far below the bounds checked here. Angles too large
//! for them are reduced by an oracle of our own, from the digits of π alone.

#[path = "single_maths/oracle.rs"]
mod oracle;

use controller_core::single::{
    asin, atan2, exp_m1, inverse_sqrt, sin_cos, sin_cos_near, sqrt, wrap,
};
use oracle::{principal, turns_per_radian, worst};
use std::f32::consts::PI;
use std::f64::consts::TAU;

const SIGN: u32 = 0x8000_0000;

/// Up to here every angle is tried.
const LIMIT: f32 = 1e4;

/// Below, x³ is lost against x, and products underflow, which slows a PC a hundredfold: one
/// argument in 61 is tried.
const TINY: f32 = 1.0 / 2_147_483_648.0;

/// 0 where a claim holds, as an error.
fn unless(claim: bool) -> f64 {
    if claim { 0.0 } else { f64::INFINITY }
}

/// Larger error of the pair, given the true one; infinite where a value leaves [−1, 1], −x does
/// not mirror it bit for bit, or the function without a range check says something else.
fn sin_cos_error(x: f32, (sine, cosine): (f64, f64)) -> f64 {
    let ((s, c), (s_of_minus, c_of_minus)) = (sin_cos(x), sin_cos(-x));
    // The sine of −0 is +0.
    let odd = x == 0.0 || s_of_minus.to_bits() == s.to_bits() ^ SIGN;
    let even = c_of_minus.to_bits() == c.to_bits();
    let inside = s.abs() <= 1.0 && c.abs() <= 1.0;
    let same = x > LIMIT || sin_cos_near(x) == (s, c);
    let (s, c) = ((f64::from(s) - sine).abs(), (f64::from(c) - cosine).abs());
    unless(odd && even && inside && same) + s.max(c)
}

#[test]
fn sin_cos_is_within_two_ten_millionths_for_every_angle_up_to_1e4() {
    // Two terms of the series suffice for small angles, and most floats are small.
    const SMALL: f32 = 1.0 / 4096.0;
    let series = |a: f64| (a - a * a * a / 6.0, 1.0 - a * a / 2.0);
    let tiny = worst(0.0, TINY, 61, |x| sin_cos_error(x, (f64::from(x), 1.0)));
    let small = worst(TINY, SMALL, 1, |x| sin_cos_error(x, series(f64::from(x))));
    let rest = worst(SMALL, LIMIT, 1, |x| {
        sin_cos_error(x, f64::from(x).sin_cos())
    });
    assert_eq!(tiny, 0.0);
    println!("sin_cos up to 1e4: {rest:.3e}, below 2⁻¹²: {small:.3e}");
    assert!(small <= 3e-8 && rest <= 1.8e-7, "{small:e} {rest:e}");
}

#[test]
fn sin_cos_is_within_two_ten_millionths_for_any_finite_angle() {
    let digits = turns_per_radian();
    let oracle = |x: f32| principal(x, &digits);
    let max = worst(LIMIT, f32::MAX, 61, |x| {
        sin_cos_error(x, oracle(x).sin_cos())
    });
    assert!(max <= 1.8e-7, "{max:e}");
    // The oracle agrees with std.
    let apart = worst(1.0, f32::MAX, 4_099, |x| {
        (oracle(x).sin() - f64::from(x).sin()).abs()
    });
    assert!(apart < 1e-15);
    for (sine, cosine) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(sin_cos) {
        assert!(sine.is_nan() && cosine.is_nan());
    }
}

#[test]
fn wrap_is_right_for_any_finite_angle() {
    let digits = turns_per_radian();
    let excess = |x: f32| {
        let w = wrap(x);
        let next = f32::from_bits((w.to_bits() & !SIGN) + 1);
        let half_ulp = (f64::from(next) - f64::from(w.abs())) / 2.0;
        let d = (f64::from(w) - principal(x, &digits)).abs();
        let d = if d > 3.2 { (d - TAU).abs() } else { d };
        unless(w > -PI && w <= PI && (w == PI || wrap(-x) == -w)) + d - half_ulp
    };
    let near = worst(PI.next_up(), LIMIT, 3, excess);
    let far = worst(LIMIT, f32::MAX, 61, excess);
    assert!(near <= 1e-9 && far <= 4e-9, "{near:e} {far:e}");
}

#[test]
fn wrap_leaves_an_angle_inside_alone() {
    let same = |x: f32| unless(wrap(x).to_bits() == x.to_bits());
    assert_eq!(worst(0.0, PI, 17, same), 0.0);
    assert_eq!(worst(-0.0, (-PI).next_up(), 17, same), 0.0);
    assert_eq!((wrap(PI), wrap(-PI)), (PI, PI));
    assert!([f32::NAN, f32::INFINITY].iter().all(|x| wrap(*x).is_nan()));
}

#[test]
fn atan2_is_within_a_quarter_of_a_millionth() {
    let error = |y: f32, x: f32| (f64::from(atan2(y, x)) - f64::from(y).atan2(f64::from(x))).abs();
    // Most ratios of the first octant, then a stride of them in all eight, at three lengths.
    let first = worst(1e-4, 1.0, 3, |y| error(y, 1.0));
    let eight = worst(1e-12, 1.0, 61, |ratio| {
        [1.0, 1.234_567_8, 3e-5].iter().fold(0.0, |max, long| {
            let short = ratio * long;
            [(short, *long), (*long, short)]
                .iter()
                .fold(max, |max, &(y, x)| {
                    let odd =
                        unless(atan2(-y, x) == -atan2(y, x) && atan2(-y, -x) == -atan2(y, -x));
                    max.max(error(y, x)).max(error(y, -x)) + odd
                })
        })
    });
    assert!(first <= 1.2e-7 && eight <= 2.5e-7, "{first:e} {eight:e}");
}

#[test]
fn atan2_follows_ieee_at_zeros_and_infinities() {
    let cases = [0.0, 1.0, f32::from_bits(1), f32::MAX, f32::INFINITY];
    let cases: Vec<f32> = cases.iter().flat_map(|v| [*v, -*v]).collect();
    for (y, x) in cases.iter().flat_map(|y| cases.iter().map(|x| (*y, *x))) {
        let (ours, std) = (f64::from(atan2(y, x)), f64::from(y).atan2(f64::from(x)));
        let same_sign = ours.is_sign_negative() == std.is_sign_negative();
        assert!(
            same_sign && (ours - std).abs() <= 2.5e-7,
            "atan2({y:e}, {x:e}) = {ours}"
        );
    }
    assert!(atan2(f32::NAN, 1.0).is_nan() && atan2(f32::INFINITY, f32::NAN).is_nan());
}

#[test]
fn asin_is_within_its_bound_on_its_whole_domain() {
    let error = |x: f32| {
        let (ours, a) = (asin(x), f64::from(x));
        // The next term of the series is below 1e-15 there.
        let truth = if x < 1e-3 {
            a + a * a * a / 6.0
        } else {
            a.asin()
        };
        unless(asin(-x).to_bits() == ours.to_bits() ^ SIGN) + (f64::from(ours) - truth).abs()
    };
    let tiny = worst(0.0, TINY, 61, |x| unless(asin(x) == x && asin(-x) == -x));
    let max = worst(TINY, 1.0, 1, error);
    assert!(tiny == 0.0 && max <= 1.4e-7, "{max:e}");
    assert!(
        [1.0_f32.next_up(), f32::NAN, f32::NEG_INFINITY]
            .iter()
            .all(|x| asin(*x).is_nan())
    );
}

#[test]
fn exp_m1_is_within_its_relative_bound_everywhere() {
    let relative = |x: f32| {
        let truth = f64::from(x).exp_m1();
        let error = (f64::from(exp_m1(x)) - truth).abs();
        unless(x > 0.0 || (exp_m1(x) >= -1.0 && error <= 6e-8)) + error / truth.abs()
    };
    let tiny = worst(0.0, TINY, 61, |x| {
        unless(exp_m1(x) == x && exp_m1(-x) == -x)
    });
    let (below, above) = (
        worst(-TINY, -200.0, 1, relative),
        worst(TINY, 88.72, 3, relative),
    );
    assert!(
        tiny == 0.0 && below <= 1e-7 && above <= 1.2e-7,
        "{below:e} {above:e}"
    );
    assert_eq!(
        [-f32::INFINITY, 88.73, f32::INFINITY].map(exp_m1),
        [-1.0, f32::INFINITY, f32::INFINITY]
    );
    assert!(exp_m1(f32::NAN).is_nan());
}

#[test]
fn sqrt_is_the_ieee_one() {
    let same = |x: f32| unless(sqrt(x).to_bits() == x.sqrt().to_bits());
    // Two binades hold every mantissa under either parity of the exponent.
    assert_eq!(
        worst(1.0, 4.0, 1, same) + worst(0.0, f32::INFINITY, 97, same),
        0.0
    );
    assert_eq!(sqrt(-0.0).to_bits(), SIGN);
    assert!(
        [-1.0, f32::NAN, f32::NEG_INFINITY]
            .iter()
            .all(|x| sqrt(*x).is_nan())
    );
}

#[test]
fn inverse_sqrt_is_within_two_ten_millionths_of_itself() {
    let error = |x: f32| (f64::from(inverse_sqrt(x)) * f64::from(x).sqrt() - 1.0).abs();
    // Two binades hold every mantissa under either parity of the exponent.
    let all = worst(1.0, 4.0, 1, error);
    let some = worst(f32::MIN_POSITIVE, f32::MAX, 97, error);
    assert!(all.max(some) <= 1.4e-7, "{all:e} {some:e}");
    let tiny = f32::from_bits(1);
    assert!((f64::from(inverse_sqrt(tiny)) * f64::from(tiny).sqrt() - 1.0).abs() < 2e-7);
    assert_eq!(
        [0.0, -0.0, f32::INFINITY].map(inverse_sqrt),
        [f32::INFINITY, f32::NEG_INFINITY, 0.0]
    );
    assert!(
        [-1.0, f32::NAN, f32::NEG_INFINITY]
            .iter()
            .all(|x| inverse_sqrt(*x).is_nan())
    );
}
