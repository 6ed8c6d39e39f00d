//! The stability limits of the core against the eigenvalues of the linearised loop and against the loop itself.

use controller_core::maths::Libm;
use controller_core::paper::stability::{
    longitudinal_tracking_is_stable, max_proven_speed, max_stable_speed, parking_is_stable,
};
use nalgebra::{Complex, Matrix4, Matrix5, Vector2, Vector3};
use proptest::prelude::*;
use tests::check::assert_within;
use tests::core_draw::{cases, decades};
use tests::core_loop::{Exact, run};
use tests::core_params::core_params;
use tests::oracle::{Params, Reference, Reset, Scenario};
use tests::stated::{At, Stated};
use tests::tolerance::{EIGENVALUE, LIMIT_SPEED, NEAR_LIMIT, ONE_DECIMAL, SETTLED, TWO_DECIMALS};

fn stable_speed(p: &Params) -> Option<f64> {
    max_stable_speed::<f64, Libm>(&core_params(p, Reset::Corrected))
}

/// Largest real part of the lateral loop (e_y, e_θ, s₂, w, ẇ_s) about a straight line, b the neuron's slope times A.
///
/// Linearised by hand: e_y' = v_r e_θ, e_θ' = -w by Eq. (9), s₂' = -A s₂ + b e_y by Eq. (17),
/// w' = -κ (w - w_c) + ẇ_s by Eq. (3) and Eq. (16), ẇ_s' = -A ẇ_s + b ẇ_c.
fn lateral_abscissa(p: &Params, b: f64, v_r: f64) -> f64 {
    largest(&lateral_roots(p, b, v_r))
}

fn largest(roots: &[Complex<f64>]) -> f64 {
    let real = roots.iter().map(|root| root.re);
    real.fold(f64::NEG_INFINITY, f64::max)
}

/// Its roots.
fn lateral_roots(p: &Params, b: f64, v_r: f64) -> Vec<Complex<f64>> {
    let (kappa, across) = (p.kd2 / p.inertia, p.k2 * v_r);
    #[rustfmt::skip]
    let loop_matrix = Matrix5::new(
        0.0,            v_r,          0.0,                 0.0,          0.0,
        0.0,            0.0,          0.0,                -1.0,          0.0,
        b,              0.0,         -p.a,                 0.0,          0.0,
        0.0,            kappa * p.k3, kappa * across,     -kappa,        1.0,
        b * across * b, 0.0,         -b * across * p.a,   -b * p.k3,    -p.a,
    );
    loop_matrix.complex_eigenvalues().iter().copied().collect()
}

/// Largest real part of one pose neuron's loop (e, s, v, v̇_s) with pose gain k: Eq. (17) or Eq. (22).
fn channel_abscissa(p: &Params, b: f64, gain: f64, kappa: f64) -> f64 {
    largest(&channel_roots(p, b, gain, kappa))
}

/// Its roots.
fn channel_roots(p: &Params, b: f64, gain: f64, kappa: f64) -> Vec<Complex<f64>> {
    #[rustfmt::skip]
    let loop_matrix = Matrix4::new(
        0.0,           0.0,            -1.0,    0.0,
        b,            -p.a,             0.0,    0.0,
        0.0,           kappa * gain,   -kappa,  1.0,
        b * gain * b, -b * gain * p.a,  0.0,   -p.a,
    );
    loop_matrix.complex_eigenvalues().iter().copied().collect()
}

/// For b = B and b = D the worse of both.
fn worse(p: &Params, abscissa: impl Fn(f64) -> f64) -> f64 {
    abscissa(p.b).max(abscissa(p.d))
}

/// Gains over four decades about the recommended ones; B = D or not.
fn gains() -> impl Strategy<Value = Params> {
    (prop::array::uniform9(decades(-2.0, 2.0)), any::<bool>()).prop_map(|(f, alike)| {
        let p = Params::recommended();
        let b = p.b * f[7];
        Params {
            k1: p.k1 * f[0],
            k2: p.k2 * f[1],
            k3: p.k3 * f[2],
            k4: p.k4 * f[3],
            k5: p.k5 * f[4],
            kd1: p.kd1 * f[5],
            kd2: p.kd2 * f[6],
            kc1: p.kd1 * f[6],
            kc2: p.kd2 * f[5],
            b,
            d: if alike { b } else { p.d * f[8] },
            ..p
        }
    })
}

proptest! {
    #![proptest_config(cases(2000))]

    /// Below the limit every root is to the left, above it one is to the right.
    #[test]
    fn speed_limit_is_where_an_eigenvalue_crosses(p in gains()) {
        let abscissa = |v_r: f64| worse(&p, |b| lateral_abscissa(&p, b, v_r));
        match stable_speed(&p) {
            Some(limit) => {
                prop_assert!(abscissa(limit * (1.0 + NEAR_LIMIT)) > 0.0, "stable above {limit}");
                for share in [0.1, 0.5, 0.9, 1.0 - NEAR_LIMIT] {
                    let found = abscissa(share * limit);
                    prop_assert!(found < 0.0, "{found:e} at {share} of {limit}");
                }
            }
            None => for v_r in [1e-2, 1e-1, 1.0, 10.0] {
                prop_assert!(abscissa(v_r) > 0.0, "stable at {v_r}");
            },
        }
    }

    /// The statements on e_x while tracking, and on e_x and e_θ while parking, are those of the eigenvalues.
    #[test]
    fn channels_are_stable_where_their_eigenvalues_are(p in gains()) {
        let core = core_params::<f64>(&p, Reset::Corrected);
        let channel = |gain, kappa| worse(&p, |b| channel_abscissa(&p, b, gain, kappa));
        let along = channel(p.k1, p.kd1 / p.m);
        let parking = channel(p.k4, p.kc1 / p.m).max(channel(p.k5, p.kc2 / p.inertia));
        for (stable, abscissa) in [
            (longitudinal_tracking_is_stable(&core), along),
            (parking_is_stable(&core), parking),
        ] {
            prop_assert!(abscissa.abs() < EIGENVALUE || stable == (abscissa < 0.0), "{stable}: {abscissa:e}");
        }
    }
}

/// The limits derived in `docs/derivation.md` for the recommended gains and for others.
#[test]
fn speed_limits_are_those_derived() {
    let p = Params::recommended();
    let scaled = |a: f64| Params { a, b: a, d: a, ..p };
    let limit = stable_speed(&p).expect("a limit");
    println!("limit {limit:.4} m/s");
    assert_within(limit, 1.215, LIMIT_SPEED, "recommended");
    let mut limits = vec![limit];
    for (p, expected) in [
        (scaled(10.0), 1.63),
        (scaled(2.0), 1.03),
        (Params { k3: 4.0, ..p }, 1.89),
        (Params { k2: 12.0, ..p }, 0.86),
    ] {
        let limit = stable_speed(&p).expect("a limit");
        println!("limit {limit:.4} m/s");
        assert_within(limit, expected, TWO_DECIMALS, "other gains");
        limits.push(limit);
    }
    let mut page = Stated::of("docs/derivation.md");
    page.exactly(
        At::Phrase("G: **# m/s**; A = B = D = 10: #; 2: #; k₃ = 4: #; k₂ = 12: #."),
        &limits,
    );
    Stated::of("README.md").exactly(At::Phrase("its fixed gains weave above # m/s"), &[limit]);
    let proven = max_proven_speed::<f64, Libm>(&core_params(&p, Reset::Corrected));
    println!("proven {proven:.4} m/s");
    assert_within(proven, 1.155, LIMIT_SPEED, "proven");
    page.exactly(
        At::Phrase("`paper::stability::max_proven_speed`; G: # m/s"),
        &[proven],
    );
    assert!(proven < limit);
}

/// The roots of both channels at 0.4 m/s, slowest first, a pair once.
#[test]
fn roots_of_the_gains_are_those_stated() {
    let p = Params::recommended();
    let figures = |mut roots: Vec<Complex<f64>>| -> Vec<f64> {
        roots.retain(|root| root.im >= 0.0);
        roots.sort_by(|a, b| b.re.total_cmp(&a.re));
        let parts = |root: &Complex<f64>| {
            let pair = (root.im > 1e-6).then_some(root.im);
            [Some(root.re), pair]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
        };
        roots.iter().flat_map(parts).collect()
    };
    let along = figures(channel_roots(&p, p.b, p.k1, p.kd1 / p.m));
    let across = figures(lateral_roots(&p, p.b, 0.4));
    Stated::of("docs/derivation.md").exactly(
        At::Phrase("At 0.4 m/s G has #, # ± #i, # along and # ± #i, #, # ± #i across"),
        &[along, across].concat(),
    );
}

/// Along the path the recommended gains are stable up to k₁ of 7.9.
#[test]
fn gain_along_the_path_has_its_limit() {
    let stable = |k1| {
        let p = Params {
            k1,
            ..Params::recommended()
        };
        longitudinal_tracking_is_stable(&core_params::<f64>(&p, Reset::Corrected))
    };
    let (mut low, mut high) = (0.9, 100.0);
    assert!(stable(low) && !stable(high));
    while high - low > 1e-6 {
        let middle = (low + high) / 2.0;
        if stable(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    println!("k1 < {low:.4}");
    assert_within(low, 7.9, ONE_DECIMAL, "k1");
    Stated::of("docs/derivation.md").exactly(At::Phrase("(κ = 3: k₁ < #)"), &[low]);
    assert!(parking_is_stable(&core_params::<f64>(
        &Params::recommended(),
        Reset::Corrected
    )));
}

/// Largest distance from the line from `from` on, at 1 ms, for a robot that starts 5 cm beside a straight line at v_r.
fn weaving(v_r: f64, duration: f64, from: f64) -> f64 {
    let scenario = Scenario {
        q0: Vector3::new(0.0, 0.05, 0.0),
        twist0: Vector2::new(v_r, 0.0),
        reference: Reference::steady([0.0; 3], v_r, 0.0),
        duration,
        switch: None,
        ..Scenario::paper_line()
    };
    run::<f64, Exact>(&scenario, 1e-3)
        .iter()
        .filter(|tick| tick.t >= from)
        .map(|tick| tick.body.q.y.abs())
        .fold(0.0, f64::max)
}

/// The loop of Eq. (15) to Eq. (17) itself: just below the limit it converges, just above it weaves for ever.
#[test]
fn loop_converges_below_the_limit_and_weaves_above() {
    let limit = stable_speed(&Params::recommended()).expect("a limit");
    let (below, above) = (
        weaving(0.95 * limit, 60.0, 50.0),
        weaving(1.25, 200.0, 190.0),
    );
    println!("beside the line: below {below:.2e} m, above {above:.3} m");
    assert!(below < SETTLED / 10.0, "{below}");
    assert_within(above, 0.10, TWO_DECIMALS, "weaving at 1.25 m/s");
    let faster = weaving(1.5, 200.0, 190.0);
    Stated::of("docs/derivation.md").exactly(
        At::Phrase("limit cycle (# cm at 1.25 m/s, # cm at 1.5)"),
        &[1e2 * above, 1e2 * faster],
    );
}
