//! Strategies of property tests over what the core accepts, for either scalar.

use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronParams;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

/// 10 to the power of anything between the two exponents.
pub fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low..=high).prop_map(|exponent| 10_f64.powf(exponent))
}

/// Any finite value of the scalar's own type, all magnitudes alike, widened.
pub fn finite<T: Scalar>() -> BoxedStrategy<f64> {
    let single = T::MAX.to_f64() < f64::MAX;
    if single {
        any::<u32>()
            .prop_map(|bits| f64::from(f32::from_bits(bits)))
            .prop_filter("finite", |value| value.is_finite())
            .boxed()
    } else {
        any::<u64>()
            .prop_map(f64::from_bits)
            .prop_filter("finite", |value| value.is_finite())
            .boxed()
    }
}

/// A neuron's input: of ordinary size, or any finite value at all.
pub fn input<T: Scalar>() -> BoxedStrategy<f64> {
    prop_oneof![
        3 => -100.0..100.0,
        1 => finite::<T>(),
        1 => Just(0.0),
        1 => prop_oneof![Just(T::MAX.to_f64()), Just(-T::MAX.to_f64())],
    ]
    .boxed()
}

/// A tick in \[0, 1e6\] s: of ordinary size, of any size, or an end of the range.
pub fn tick() -> BoxedStrategy<f64> {
    prop_oneof![
        2 => 0.0..0.1,
        2 => decades(-9.0, 6.0),
        1 => prop_oneof![Just(0.0), Just(1e6), Just(5e-324)],
    ]
    .boxed()
}

/// Everything that is accepted for A, B, D; B and D differ.
pub fn neuron_params<T: Scalar>() -> impl Strategy<Value = NeuronParams<T>> {
    let end = || {
        prop_oneof![
            6 => decades(-3.0, 4.0),
            1 => prop_oneof![Just(1e-3), Just(1e4)],
        ]
    };
    (end(), end(), end()).prop_map(|(a, b, d)| NeuronParams {
        a: inside::<T>(a),
        b: inside::<T>(b),
        d: inside::<T>(d),
    })
}

/// Rounded into the accepted range.
fn inside<T: Scalar>(value: f64) -> T {
    T::from_f64(value.clamp(1e-3, 1e4))
}

/// Settings of a property test: so many cases, the same ones everywhere unless `PROPTEST_RNG_SEED` names others.
pub fn cases(cases: u32) -> Config {
    let mut config = Config::with_cases(cases);
    config.failure_persistence = None;
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(0x5EED_0002);
    }
    config
}
