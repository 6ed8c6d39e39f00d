//! The neuron of Eq. (4) is in [-D, B] after everything that it accepts, and refuses the rest.
//!
//! By drawn neurons, inputs and ticks, and by every single-precision input there is.

use controller_core::error::NeuronError;
use controller_core::maths::{Libm, Maths, Micromath, Single};
use controller_core::neuron::Neuron;
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronParams;
use controller_core::shunting::{ExactHeld, ExactMean, NeuronUpdate, RationalMean, Shunting};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tests::core_draw::{cases, input, neuron_params, tick};
use tests::tolerance::SETTLED_NEURON;

/// Neurons per scalar, update and back end; each takes [`STEPS`] steps.
const NEURONS: u32 = 64;
/// Steps of each neuron.
const STEPS: usize = 3000;

/// The state is in \[-D, B\] after every step, for the stand-alone neuron and for the controller's inputs.
fn bounded<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>() {
    let mut runner = TestRunner::new(cases(NEURONS));
    let steps = prop::collection::vec((input::<T>(), input::<T>(), tick()), STEPS);
    runner
        .run(
            &(neuron_params::<T>(), 0.0..=1.0, steps),
            |(params, share, steps)| {
                let shunting = Shunting::new(&params).expect("drawn from the accepted range");
                let (upper, lower) = (shunting.upper(), shunting.lower());
                let start: f64 = lower.to_f64() + share * (upper.to_f64() - lower.to_f64());
                let start = T::from_f64(start.clamp(lower.to_f64(), upper.to_f64()));
                let mut state = start;
                for (before, now, dt) in steps {
                    let input = (T::from_f64(before), T::from_f64(now));
                    state = shunting.step::<U, M>(state, input, T::from_f64(dt));
                    prop_assert!(
                        state >= lower && state <= upper,
                        "{state:?} outside [{lower:?}, {upper:?}] by {input:?} over {dt}"
                    );
                    let settled = shunting.equilibrium(input.1);
                    prop_assert!(settled >= lower && settled <= upper);
                }
                Ok(())
            },
        )
        .unwrap_or_else(|error| panic!("{error}"));
}

/// Eq. (4): \[-D, B\] is never left in double precision, by any rule.
#[test]
fn bound_holds_for_every_input_and_tick_in_double_precision() {
    bounded::<f64, Libm, ExactHeld>();
    bounded::<f64, Libm, ExactMean>();
    bounded::<f64, Libm, RationalMean>();
}

/// Eq. (4): \[-D, B\] is never left in single precision, by any rule and back end.
#[test]
fn bound_holds_for_every_input_and_tick_in_single_precision() {
    bounded::<f32, Libm, ExactHeld>();
    bounded::<f32, Libm, ExactMean>();
    bounded::<f32, Libm, RationalMean>();
    bounded::<f32, Single, ExactHeld>();
    bounded::<f32, Single, ExactMean>();
    bounded::<f32, Micromath, ExactMean>();
    bounded::<f32, Micromath, RationalMean>();
}

fn refuses<T: Scalar, M: Maths<T>>() {
    let (not_a_number, infinite) = (T::from_f64(f64::NAN), T::from_f64(f64::INFINITY));
    let f = T::from_f64;
    let params = NeuronParams {
        a: f(4.0),
        b: f(2.0),
        d: f(1.0),
    };
    let shunting = Shunting::new(&params).unwrap();
    for outside in [
        f(2.000_001),
        f(-1.000_001),
        not_a_number,
        infinite,
        -infinite,
    ] {
        assert_eq!(
            Neuron::new(shunting, outside),
            Err(NeuronError::OutOfBounds)
        );
    }
    for end in [f(2.0), f(-1.0)] {
        assert_eq!(Neuron::new(shunting, end).unwrap().state(), end);
    }
    let mut neuron = Neuron::new(shunting, f(0.5)).unwrap();
    for input in [not_a_number, infinite, -infinite] {
        let refused = neuron.advance::<ExactHeld, M>(input, f(0.1));
        assert_eq!(refused, Err(NeuronError::InputNotFinite));
    }
    for dt in [not_a_number, f(-1e-9), -infinite] {
        let refused = neuron.advance::<ExactHeld, M>(f(1.0), dt);
        assert_eq!(refused, Err(NeuronError::TickNegative));
    }
    assert_eq!(neuron.state(), f(0.5), "a refusal changes nothing");
    assert_eq!(neuron.advance::<ExactHeld, M>(f(1.0), T::ZERO), Ok(f(0.5)));
    let settled = neuron.advance::<ExactHeld, M>(f(1.0), infinite).unwrap();
    let short = (settled - shunting.equilibrium(f(1.0))).abs();
    assert!(
        short <= f(SETTLED_NEURON) * T::EPSILON / f(f64::EPSILON),
        "{short:?}"
    );
}

/// A start outside \[-D, B\], an input that is no number and a time that runs back are reported, and change nothing.
#[test]
fn neuron_refuses_what_it_cannot_use() {
    refuses::<f64, Libm>();
    refuses::<f32, Libm>();
    refuses::<f32, Single>();
}

/// Tries the inputs with bits `first`, `first + 2`, … and returns how many were finite.
fn every_other_input<U: NeuronUpdate<f32>>(first: u32) -> u32 {
    let params = NeuronParams {
        a: 4.0_f32,
        b: 3.0,
        d: 0.7,
    };
    let shunting = Shunting::new(&params).expect("in range");
    let starts = [-0.7, 3.0, 0.1, 0.0];
    let starts = starts.map(|state| Neuron::new(shunting, state).expect("inside"));
    let mut finite = 0;
    for half in 0..=u32::MAX / 2 {
        let bits = 2 * half + first;
        let input = f32::from_bits(bits);
        let mut neuron = starts[(half % 4) as usize];
        match neuron.advance::<U, Single>(input, 0.01) {
            Ok(state) => {
                finite += 1;
                assert!(input.is_finite(), "{bits:#x} was accepted");
                assert!((-0.7..=3.0).contains(&state), "{state} by {input:e}");
                assert_eq!(state, neuron.state());
            }
            Err(error) => {
                assert!(!input.is_finite(), "{input:e} was refused");
                assert_eq!(error, NeuronError::InputNotFinite);
                assert_eq!(neuron, starts[(half % 4) as usize]);
            }
        }
    }
    finite
}

/// All 2^32 inputs, half of them on either thread.
fn exhaustive<U: NeuronUpdate<f32>>() {
    let started = std::time::Instant::now();
    let finite = std::thread::scope(|scope| {
        let odd = scope.spawn(|| every_other_input::<U>(1));
        every_other_input::<U>(0) + odd.join().expect("no input breaks the bound")
    });
    println!(
        "{finite} finite inputs in {:.1} s",
        started.elapsed().as_secs_f64()
    );
    // 2 signs, 255 exponents, 2^23 mantissas.
    assert_eq!(finite, (2 * 255) << 23);
}

/// Eq. (4): bound kept for every finite `f32`, every other one refused; the fastest update.
#[test]
fn every_single_precision_input_keeps_the_bound_or_is_refused_rational() {
    exhaustive::<RationalMean>();
}

/// Eq. (4): bound kept for every finite `f32`, every other one refused; the exact update.
#[test]
fn every_single_precision_input_keeps_the_bound_or_is_refused_exact() {
    exhaustive::<ExactHeld>();
}
