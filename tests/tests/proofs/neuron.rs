//! Theorem 1: a neuron in [-D, B] stays there.

use controller_core::maths::Single;
use controller_core::shunting::{NeuronParams, NeuronUpdate, RationalMean, Shunting};

use crate::corners;

/// ε of single precision.
const EPSILON: f64 = f32::EPSILON as f64;

/// Lemma 1.1, for every x ≥ 0 there is: the share of the default update is in [0, 1 − 2ε], and no number gives a NaN.
#[test]
fn the_share_of_a_tick_is_below_one_by_two_roundings_for_every_number() {
    let most = 1.0 - 2.0 * f32::EPSILON;
    let mut largest = 0.0_f32;
    for bits in 0..=f32::INFINITY.to_bits() {
        let share = <RationalMean as NeuronUpdate<f32>>::share::<Single>(f32::from_bits(bits));
        // Infinity is no time constant: 1/(2 (A + |u|)) · 2/dt is at most 250 · 1e18.
        let counts = bits < f32::INFINITY.to_bits();
        assert!(
            !counts || (0.0..=most).contains(&share),
            "{bits:#x}: {share:e}"
        );
        if counts && share > largest {
            largest = share;
        }
    }
    println!(
        "largest share: 1 - {:.2} epsilon",
        (1.0 - f64::from(largest)) / EPSILON
    );
}

/// Lemma 1.2, for every S in [2e-3, 1e32]: fl(S fl(1/S)) ≤ 1. With |2u| ≤ S = fl(2A + |2u|), and since rounding is monotone, what the
/// input leads to is at most `pull`, which is below the bound.
#[test]
fn a_quotient_by_reciprocal_is_at_most_one_for_every_divisor() {
    let (from, to) = (2.0e-3_f32.to_bits(), 1.0e32_f32.to_bits());
    for bits in from..=to {
        let s = f32::from_bits(bits);
        let product = s * (1.0 / s);
        assert!(product <= 1.0, "{s:e}: {product:e}");
    }
}

/// Lemma 1.3, for every positive d: fl((1 − 2ε) d) ≤ (1 − ε) d where d is normal, and ≤ d where it is not. A difference is rounded up
/// by ε/2 of itself at most, and not at all where it is subnormal: so a step never passes what it goes to.
#[test]
fn the_largest_share_of_a_difference_is_short_of_it_for_every_difference() {
    let share = 1.0 - 2.0 * f32::EPSILON;
    for bits in 1..f32::INFINITY.to_bits() {
        let d = f32::from_bits(bits);
        // Exact: 24 bits times 24 bits.
        let short = if d.is_normal() {
            (1.0 - EPSILON) * f64::from(d)
        } else {
            f64::from(d)
        };
        assert!(f64::from(share * d) <= short, "{d:e}");
    }
}

/// Theorem 1 by trial, where a float changes its kind: bounds, states, inputs and times of all binades, zero, subnormals, 1e6 s and the
/// largest number.
#[test]
fn the_bound_holds_at_the_corners_of_all_arguments() {
    let limits = [1.0e-3_f32, 0.999_999_9, 1.0, 1.000_000_1, 3.3, 1.0e4];
    let inputs = corners(4);
    let times: Vec<f32> = [0.0, 1.0e6].into_iter().chain(corners(6)).collect();
    let mut tried = 0_u64;
    for (i, &a) in [1.0e-3_f32, 4.0, 1.0e4].iter().enumerate() {
        for &b in &limits {
            let d = limits[(i + 3) % limits.len()];
            let shunting = Shunting::new(&NeuronParams { a, b, d }).expect("in range");
            let states = [
                -d,
                -d.next_down(),
                -d * 0.5,
                -f32::MIN_POSITIVE,
                -0.0,
                0.0,
                f32::from_bits(1),
                b * 0.5,
                b.next_down(),
                b,
            ];
            for &size in &inputs {
                for input in [size, -size] {
                    // The other end of the tick: nothing, the same, or the opposite.
                    for before in [0.0, input, -input] {
                        for &dt in &times {
                            for state in states {
                                let next = shunting.step::<RationalMean, Single>(
                                    state,
                                    (before, input),
                                    dt,
                                );
                                assert!(
                                    (-d..=b).contains(&next),
                                    "A {a} B {b} D {d}: {state:e} by ({before:e}, {input:e}) over {dt:e} is {next:e}"
                                );
                                tried += 1;
                            }
                        }
                    }
                }
            }
        }
    }
    println!("{tried} ticks");
}
