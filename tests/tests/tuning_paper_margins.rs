//! Margins of the paper's law, against its largest stable speed, simulations of others and eigenvalues.

use controller_core::maths::{Libm, Single};
use controller_core::paper::params::Params as CoreParams;
use controller_core::paper::tuning;
use controller_core::tuning::LoopMargins;
use nalgebra::{Matrix5, Vector2};
use proptest::prelude::*;
use tests::check::assert_within;
use tests::core_draw::{cases, decades};
use tests::stated::{At, Stated};
use tests::tolerance::LIMIT_SPEED;

/// The largest stable speed of the paper's law is where its lateral margins vanish.
#[test]
fn largest_stable_speed_is_where_the_margins_end() {
    let params = CoreParams::<f64>::paper();
    let at = |speed| tuning::margins::<f64, Libm>(&params, speed);
    let limit = at(0.4).max_speed;
    let delays = [0.4, 0.8, 1.0].map(|speed| at(speed).lateral.pose_delay_s);
    Stated::of("docs/tuning.md").exactly(
        At::Phrase(
            "lost with poses # s old at 0.4 m/s, # s at 0.8, # s at 1.0, and with fresh ones above # m/s",
        ),
        &[delays[0], delays[1], delays[2], limit],
    );
    assert_within(limit, 1.215, LIMIT_SPEED, "recommended gains");
    // On both sides of a bisection's last bits.
    let (below, above) = (
        at(limit * (1.0 - 1e-6)).lateral,
        at(limit * (1.0 + 1e-6)).lateral,
    );
    assert!(below.is_stable() && !above.is_stable());
    assert!(below.pose_delay_s < 1e-3 && above.pose_delay_s == 0.0);
    // A factor g on the pose's gain is not one on the speed; their common limit is.
    assert!((at(limit).lateral.gain - 1.0).abs() < 1e-4 || at(limit).lateral.gain == 0.0);
    // Hand-computed: 4 · 0.9 · 90 and 4 · 6 · 2 · 75.
    let found = at(0.4);
    assert!((found.lyapunov_longitudinal - 324.0).abs() < 1e-9);
    assert!((found.lyapunov_lateral - 3600.0).abs() < 1e-9);
    println!("G at 0.4 m/s: {:.3?}", found.lateral);
}

/// Latency at which the paper's law was lost in simulations by others: 740 ms at 0.4 m/s, 250 at 0.8, 100 at 1.0.
#[test]
fn delay_margins_of_the_paper_are_those_simulated() {
    let params = CoreParams::<f64>::paper();
    for (speed, lost_s) in [(0.4, 0.74), (0.8, 0.25), (1.0, 0.10)] {
        let found = tuning::margins::<f64, Libm>(&params, speed)
            .lateral
            .pose_delay_s;
        println!("{speed} m/s: {found:.3} s, simulated {lost_s}");
        // Simulated with large errors, in steps of 10 to 20 ms, at a tick of 10 ms.
        assert!((found - lost_s).abs() < 0.03, "{found} for {lost_s}");
    }
}

/// Roots of the lateral loop of the paper by eigenvalues: matrix as in `stability_limits.rs`.
fn roots(p: &CoreParams<f64>, v_r: f64) -> Vec<Vector2<f64>> {
    let (g, a, b) = (&p.tracking, p.neurons.a, p.neurons.b);
    let (kappa, across) = (g.k_d2 / p.robot.inertia_kg_m2, g.k2 * v_r);
    #[rustfmt::skip]
    let matrix = Matrix5::new(
        0.0,            v_r,          0.0,             0.0,          0.0,
        0.0,            0.0,          0.0,            -1.0,          0.0,
        b,              0.0,         -a,               0.0,          0.0,
        0.0,            kappa * g.k3, kappa * across, -kappa,        1.0,
        b * across * b, 0.0,         -b * across * a, -b * g.k3,    -a,
    );
    let found = matrix.complex_eigenvalues();
    found
        .iter()
        .map(|root| Vector2::new(root.re, root.im))
        .collect()
}

proptest! {
    #![proptest_config(cases(300))]

    /// Decay and damping are those of the eigenvalues, in double and in single precision.
    #[test]
    fn decay_and_damping_are_those_of_the_eigenvalues(f in prop::array::uniform6(decades(-0.5, 0.5))) {
        let mut p = CoreParams::<f64>::paper();
        p.tracking.k2 *= f[0];
        p.tracking.k3 *= f[1];
        p.tracking.k_d2 *= f[2];
        p.neurons.a *= f[3];
        p.neurons.b *= f[4];
        p.neurons.d = p.neurons.b;
        let speed = 0.4 * f[5];
        let roots = roots(&p, speed);
        let decay = roots.iter().map(|root| -root.x).fold(f64::INFINITY, f64::min);
        let damping = roots.iter().map(|root| -root.x / root.norm()).fold(1.0, f64::min);
        let found = tuning::margins::<f64, Libm>(&p, speed).lateral;
        // Roots that nearly coincide are known to the square root of rounding only.
        prop_assert!((found.decay - decay).abs() < 1e-6 * (1.0 + decay.abs()), "{} {decay}", found.decay);
        prop_assert!((found.damping - damping.max(0.0)).abs() < 1e-5, "{} {damping}", found.damping);
        let single = tuning::margins::<f32, Single>(&p.cast(), speed as f32).lateral;
        let clear = found.decay.abs() > 0.01;
        let near = |a: f64, b: f32| (a - f64::from(b)).abs() < 0.02 * (0.1 + a.abs());
        let LoopMargins { decay, pose_delay_s, torque_delay_s, .. } = found;
        prop_assert!(!clear || near(decay, single.decay), "{decay} {}", single.decay);
        prop_assert!(!clear || near(pose_delay_s, single.pose_delay_s));
        prop_assert!(!clear || near(torque_delay_s, single.torque_delay_s));
    }
}
