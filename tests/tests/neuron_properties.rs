//! The solution of the shunting equation, Eq. (4) and Eq. (5): what `advance` does beside staying in its bounds.

use controller_core::maths::{Libm, Maths};
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronParams;
use controller_core::shunting::{
    ExactHeld, ExactMean, NeuronUpdate, RationalMean, Shunting, excitatory, inhibitory,
};
use proptest::prelude::*;
use tests::check::assert_close;
use tests::core_draw::{cases, decades, input, neuron_params};
use tests::oracle::{Params, neuron};
use tests::stated::{At, Stated};
use tests::tolerance::{
    MEAN_GAIN, MEAN_ORDER, NEURON_ALGEBRA, NEURON_RUNGE_KUTTA, RATIONAL_GAIN, RATIONAL_SHARE,
};

/// The core's neuron and the constants of the oracle's.
fn both(params: &NeuronParams<f64>) -> (Shunting<f64>, Params) {
    let p = Params {
        a: params.a,
        b: params.b,
        d: params.d,
        ..Params::recommended()
    };
    (Shunting::new(params).expect("in range"), p)
}

/// Distance of a state to \[-D, B\].
fn outside<T: Scalar>(shunting: &Shunting<T>, state: T) -> f64 {
    let over = (state - shunting.upper()).to_f64();
    let under = (shunting.lower() - state).to_f64();
    over.max(under).max(0.0)
}

/// A tick that is short beside the fastest rate, or not.
fn ticks() -> impl Strategy<Value = f64> {
    decades(-6.0, 1.0)
}

fn relaxes<U: NeuronUpdate<f64>>(
    params: &NeuronParams<f64>,
    times: f64,
    u: f64,
    dt: f64,
) -> Result<(), TestCaseError> {
    let (neuron, _) = both(params);
    let bound = if times > 0.0 { params.b } else { params.d };
    let mut state = times * bound;
    for _ in 0..200 {
        let before = outside(&neuron, state);
        let next = neuron.step::<U, Libm>(state, (u, u), dt);
        let after = outside(&neuron, next);
        prop_assert!(after <= before, "{before:e} grows to {after:e}");
        prop_assert!(
            next * state > 0.0 || after == 0.0,
            "flew past the bounds: {next:e}"
        );
        state = next;
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(256))]

    /// Eq. (4) and Eq. (5), as the oracle writes them.
    #[test]
    fn rate_is_the_printed_one(
        params in neuron_params::<f64>(), share in -2.0..2.0_f64, u in -1e3..1e3_f64,
    ) {
        let (neuron, p) = both(&params);
        let s = share * params.b;
        let scale = (params.a + u.abs()) * (s.abs() + params.b + params.d);
        let difference = neuron.rate(s, u) - neuron::rate(&p, s, u);
        prop_assert!(difference.abs() <= NEURON_ALGEBRA * scale);
        prop_assert_eq!(excitatory(u), neuron::s_plus(u));
        prop_assert_eq!(inhibitory(u), neuron::s_minus(u));
        prop_assert!(neuron.rate(neuron.equilibrium(u), u).abs() <= NEURON_ALGEBRA * scale);
    }

    /// The exact update is the solution of Eq. (4): the oracle's, and that of a fine integration of `rate`.
    #[test]
    fn exact_update_solves_the_equation(
        params in neuron_params::<f64>(), share in 0.0..1.0_f64, u in -100.0..100.0_f64, a in 0.0..20.0_f64,
    ) {
        let (neuron, p) = both(&params);
        let s = share * (params.b + params.d) - params.d;
        let dt = a / (params.a + u.abs());
        let found = neuron.step::<ExactHeld, Libm>(s, (u, u), dt);
        let scale = params.b + params.d;
        prop_assert!((found - neuron::held(&p, s, u, dt)).abs() <= NEURON_ALGEBRA * scale);
        let (steps, mut state) = (1000, s);
        let h = dt / f64::from(steps);
        for _ in 0..steps {
            let k1 = neuron.rate(state, u);
            let k2 = neuron.rate(state + h / 2.0 * k1, u);
            let k3 = neuron.rate(state + h / 2.0 * k2, u);
            let k4 = neuron.rate(state + h * k3, u);
            state += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
        prop_assert!((found - state).abs() <= NEURON_RUNGE_KUTTA * scale, "{found} {state}");
    }

    /// Two ticks with one input are one tick of their sum, Eq. (4) being autonomous.
    #[test]
    fn exact_update_may_be_split(
        params in neuron_params::<f64>(), share in 0.0..1.0_f64, u in input::<f64>(), one in ticks(), two in ticks(),
    ) {
        let (neuron, _) = both(&params);
        let s = share * (params.b + params.d) - params.d;
        let advance = |s, dt| neuron.step::<ExactHeld, Libm>(s, (u, u), dt);
        let difference = advance(advance(s, one), two) - advance(s, one + two);
        prop_assert!(difference.abs() <= NEURON_ALGEBRA * (params.b + params.d));
    }

    /// Two states under one input approach each other at least as fast as exp(-A t).
    #[test]
    fn two_solutions_with_one_input_approach(
        params in neuron_params::<f64>(), shares in (0.0..1.0_f64, 0.0..1.0_f64),
        inputs in prop::collection::vec(-1e3..1e3_f64, 50), dt in ticks(),
    ) {
        let (neuron, _) = both(&params);
        let range = params.b + params.d;
        let (mut s, mut z) = (shares.0 * range - params.d, shares.1 * range - params.d);
        let first = (s - z).abs();
        for (k, u) in inputs.iter().enumerate() {
            s = neuron.step::<ExactMean, Libm>(s, (*u, *u), dt);
            z = neuron.step::<ExactMean, Libm>(z, (*u, *u), dt);
            let allowed = first * (-params.a * dt * (k + 1) as f64).exp();
            prop_assert!((s - z).abs() <= allowed + NEURON_ALGEBRA * range);
        }
    }

    /// From outside the state comes back without turning away or flying past, by any rule.
    #[test]
    fn relaxation_from_outside_is_monotone(
        params in neuron_params::<f64>(), times in prop_oneof![1.0..1e6_f64, -1e6..-1.0_f64],
        u in input::<f64>(), dt in ticks(),
    ) {
        relaxes::<ExactHeld>(&params, times, u, dt)?;
        relaxes::<ExactMean>(&params, times, u, dt)?;
        relaxes::<RationalMean>(&params, times, u, dt)?;
    }

    /// From outside the exact update is at least as fast as exp(-A t), and inside after ln(|s₀|/bound)/A.
    #[test]
    fn relaxation_from_outside_takes_finite_time(
        params in neuron_params::<f64>(), times in prop_oneof![1.01..1e6_f64, -1e6..-1.01_f64],
        u in -1e3..1e3_f64, parts in 1..40_u32,
    ) {
        let (neuron, _) = both(&params);
        let bound = if times > 0.0 { params.b } else { params.d };
        let time = times.abs().ln() / params.a;
        let dt = time / f64::from(parts);
        let mut state = times * bound;
        let first = outside(&neuron, state);
        for k in 1..=parts {
            state = neuron.step::<ExactHeld, Libm>(state, (u, u), dt);
            let allowed = first * (-params.a * dt * f64::from(k)).exp();
            prop_assert!(outside(&neuron, state) <= allowed + NEURON_ALGEBRA * times.abs() * bound);
        }
        prop_assert!(outside(&neuron, state) <= NEURON_ALGEBRA * times.abs() * bound);
    }

    /// The rational share is never above the exact one, and as near to it as its documentation says.
    #[test]
    fn rational_share_is_below_the_exact_one_and_near(a in decades(-9.0, 0.0)) {
        let share = |rational| if rational {
            <RationalMean as NeuronUpdate<f64>>::share::<Libm>(1.0 / a)
        } else {
            <ExactMean as NeuronUpdate<f64>>::share::<Libm>(1.0 / a)
        };
        let (exact, rational) = (share(false), share(true));
        prop_assert!(rational <= exact * (1.0 + NEURON_ALGEBRA));
        let limit = if a <= 0.1 { RATIONAL_SHARE.0 } else { RATIONAL_SHARE.1 };
        prop_assert!(1.0 - rational / exact <= limit, "{a}: {exact} {rational}");
    }
}

/// Largest error of a neuron with u = 2 sin 3t over 10 s, in steps of `dt`, against Eq. (4) integrated finely.
fn sine_error<U: NeuronUpdate<f64>>(dt: f64) -> f64
where
    Libm: Maths<f64>,
{
    sine_error_of(dt, |neuron, s, inputs| {
        neuron.step::<U, Libm>(s, inputs, dt)
    })
}

/// The same for any update from a state and the inputs before and after.
fn sine_error_of(dt: f64, update: impl Fn(&Shunting<f64>, f64, (f64, f64)) -> f64) -> f64 {
    let params = Params::recommended();
    let neuron = Shunting::new(&NeuronParams {
        a: 4.0,
        b: 4.0,
        d: 4.0,
    })
    .expect("in range");
    let u = |t: f64| 2.0 * (3.0 * t).sin();
    let (mut s, mut fine, mut worst) = (0.0, 0.0, 0.0);
    let parts = 100;
    let h = dt / f64::from(parts);
    for k in 0..(10.0 / dt).round() as i32 {
        let t = f64::from(k) * dt;
        s = update(&neuron, s, (u(t), u(t + dt)));
        for i in 0..parts {
            let middle = t + (f64::from(i) + 0.5) * h;
            fine = neuron::held(&params, fine, u(middle), h);
        }
        worst = f64::max(worst, (s - fine).abs());
    }
    worst
}

/// For a smooth input the mean of both ends is second order in the tick, the held input first.
#[test]
fn mean_input_is_second_order_and_a_hundred_times_closer() {
    let held = [10e-3, 5e-3].map(sine_error::<ExactHeld>);
    let mean = [10e-3, 5e-3].map(sine_error::<ExactMean>);
    let rational = [10e-3, 5e-3].map(sine_error::<RationalMean>);
    println!(
        "10 ms: held {:.2e}, mean {:.2e}, rational {:.2e}",
        held[0], mean[0], rational[0]
    );
    assert_close((held[0] / held[1]).log2(), 1.0, MEAN_ORDER, "order, held");
    assert_close((mean[0] / mean[1]).log2(), 2.0, MEAN_ORDER, "order, mean");
    let order = (rational[0] / rational[1]).log2();
    assert_close(order, 2.0, MEAN_ORDER, "order, rational");
    assert!(held[0] > MEAN_GAIN * mean[0] && held[0] > RATIONAL_GAIN * rational[0]);

    // Euler's, which the core does not have: the step is a share θ, or θ/(1 + θ), of the way to the equilibrium.
    let dt = 10e-3;
    let theta = |u: f64| dt * (4.0 + u.abs());
    let towards = |share: f64, s: f64, equilibrium: f64| s + share * (equilibrium - s);
    let explicit = sine_error_of(dt, |n, s, (old, _)| {
        towards(theta(old), s, n.equilibrium(old))
    });
    let implicit = |u: f64, n: &Shunting<f64>, s: f64| {
        towards(theta(u) / (1.0 + theta(u)), s, n.equilibrium(u))
    };
    let old = sine_error_of(dt, |n, s, (old, _)| implicit(old, n, s));
    let new = sine_error_of(dt, |n, s, (_, new)| implicit(new, n, s));
    let mut page = Stated::of("docs/derivation.md");
    let mut row = |label, measured: &[f64]| {
        let column = "max error, u = 2 sin 3t, h = 10 ms";
        page.exactly(At::Cell("Discretisation", label, column), measured);
    };
    row("explicit Euler (not offered)", &[explicit]);
    row("implicit Euler (not offered)", &[old, new]);
    row("`shunting::ExactHeld`", &[held[0]]);
    row("`shunting::ExactMean`", &[mean[0]]);
    row("`shunting::RationalMean` (default)", &[rational[0]]);
}
