//! Polynomials whose roots are known.

use super::*;
use crate::maths::Libm;

/// (λ + 1)(λ + 2)(λ² + 2·0.6·3 λ + 9).
fn known() -> Polynomial<f64> {
    Polynomial::new([1.0, 1.0])
        .times(&Polynomial::new([2.0, 1.0]))
        .times(&Polynomial::new([9.0, 3.6, 1.0]))
}

#[test]
fn routh_finds_decay_and_damping_of_known_roots() {
    // Bisection leaves some units of the last place, the turned polynomial their square root.
    let p = known();
    assert!(p.is_hurwitz());
    let rate = p.coefficient(3) / 4.0;
    let decay = rate * p.in_units_of(rate).decay();
    assert!((decay - 1.0).abs() < 1e-9, "{decay}");
    let damping = p.damping::<Libm>();
    assert!((damping - 0.6).abs() < 1e-9, "{damping}");
}

/// A factor moves no root, not even one below 0.
#[test]
fn a_sign_does_not_make_a_polynomial_grow() {
    assert!(known().scaled(-1.0).is_hurwitz());
    assert!(!Polynomial::new([1.5, -2.5, -1.0]).is_hurwitz());
}

/// At a complex number, the product of its factors there.
#[test]
fn a_complex_value_is_the_product_of_the_factors() {
    let z = (0.3, 1.7);
    let times = |(a, b): (f64, f64), (c, d): (f64, f64)| (a * c - b * d, a * d + b * c);
    let square = times(z, z);
    let quadratic = (square.0 + 3.6 * z.0 + 9.0, square.1 + 3.6 * z.1);
    let expected = times(times((z.0 + 1.0, z.1), (z.0 + 2.0, z.1)), quadratic);
    let (re, im) = known().value_at(z);
    assert!((re - expected.0).abs() < 1e-12 && (im - expected.1).abs() < 1e-12);
}

#[test]
fn growing_roots_are_told() {
    // Roots 0.5 and −3: decay −0.5, no damping.
    let p = Polynomial::new([-1.5, 2.5, 1.0]);
    assert!(!p.is_hurwitz());
    assert!((p.decay() + 0.5).abs() < 1e-9);
    assert_eq!(p.damping::<Libm>(), 0.0);
    // On the axis is not stable.
    assert!(!Polynomial::new([1.0, 0.0, 1.0]).is_hurwitz());
}

#[test]
fn positive_roots_are_all_found() {
    let p = Polynomial::new([-1.0, 1.0])
        .times(&Polynomial::new([-2.0, 1.0]))
        .times(&Polynomial::new([-2.5, 1.0]))
        .times(&Polynomial::new([4.0, 1.0]));
    let (roots, _) = p.positive_roots();
    let mut expected = [1.0, 2.0, 2.5].into_iter();
    for root in roots {
        let expected = expected.next().expect("three");
        assert!((root - expected).abs() < 1e-9, "{root}");
    }
    assert!(expected.next().is_none());
}

#[test]
fn magnitude_is_that_on_the_imaginary_axis() {
    let p = known();
    let (re, im) = p.value_at((0.0, 1.7));
    let found = p.squared_magnitude().value(1.7 * 1.7);
    assert!((found - (re * re + im * im)).abs() < 1e-9 * found);
}
