//! Gains from a design specification for the paper's law: times and tolerances met in closed loop, refusals with their limit.

use controller_core::maths::Libm;
use controller_core::paper::params::Params as CoreParams;
use controller_core::paper::tuning::{DesignSpec, Tolerance, gains, margins};
use controller_core::tuning::{DesignError, DesignParameter, Why};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use tests::core_draw::cases;
use tests::core_loop::{Exact, run};
use tests::oracle::{Params, Reference, Scenario};
use tests::stated::{At, Stated};
use tests::tuning_loop::paper_constants;

/// Settling time found over time specified: the linear response, stretched by a fit for the neurons; a heading of up to
/// 0.9 rad counts with its sine.
const MET: f64 = 0.05;

fn tuned(spec: &DesignSpec<f64>) -> Result<CoreParams<f64>, DesignError> {
    gains::<f64, Libm>(&CoreParams::paper(), spec)
}

/// When 0.5 m along or across a line stay below 5 cm \[s\], and the largest force and moment on the way.
fn drive(p: &Params, speed: f64, offset: Vector2<f64>, end: f64) -> (f64, Vector2<f64>) {
    let scenario = Scenario {
        params: *p,
        q0: Vector3::new(-offset.x, offset.y, 0.0),
        twist0: Vector2::new(speed, 0.0),
        reference: Reference::steady([0.0; 3], speed, 0.0),
        duration: end,
        switch: None,
        ..Scenario::paper_line()
    };
    let ticks = run::<f64, Exact>(&scenario, 5e-3);
    let left = |tick: &tests::core_loop::Tick<f64>| tick.error().xy().norm();
    let last = ticks
        .iter()
        .rfind(|tick| left(tick) >= 0.05)
        .expect("0.5 m at the start");
    let peak = ticks
        .iter()
        .fold(Vector2::zeros(), |peak: Vector2<f64>, tick| {
            tick.tau().abs().sup(&peak)
        });
    (last.t, peak)
}

#[test]
fn specified_times_are_met() {
    let mut worst = 0.0_f64;
    for (settling_s, speed) in [
        (3.0, 0.8),
        (4.0, 0.6),
        (5.0, 0.4),
        (5.0, 1.0),
        (8.0, 0.3),
        (15.0, 0.2),
        (20.0, 1.0),
    ] {
        for damping in [0.7, 0.85, 0.95] {
            let spec = DesignSpec {
                damping,
                ..DesignSpec::settling(settling_s, speed)
            };
            let core =
                tuned(&spec).unwrap_or_else(|error| panic!("{settling_s} s, {speed} m/s: {error}"));
            core.validate().expect("in range");
            let p = paper_constants(&core);
            let end = 3.0 * settling_s;
            let (across, _) = drive(&p, speed, Vector2::new(0.0, 0.5), end);
            let (along, _) = drive(&p, speed, Vector2::new(0.5, 0.0), end);
            println!(
                "{settling_s} s at {speed} m/s, {damping}: across {across:.2} along {along:.2} s; {:?} A {:.2}",
                core.tracking, core.neurons.a
            );
            for found in [across, along] {
                worst = worst.max((found / settling_s - 1.0).abs());
                assert!(
                    (found / settling_s - 1.0).abs() < MET,
                    "{found} for {settling_s}"
                );
            }
            let found = margins::<f64, Libm>(&core, speed);
            assert!(
                (found.lateral.damping - damping).abs() < 0.01 || found.lateral.damping < damping
            );
            assert!(found.max_speed > 1.5 * speed && found.lyapunov_longitudinal >= 1.0);
        }
    }
    Stated::of("docs/tuning.md").exactly(
        At::Phrase("within # % for 3 to 20 s, 0.2 to 1 m/s (`tuning_paper.rs"),
        &[1e2 * worst],
    );
}

/// Refused: the limit can be had, and the torque that was the reason stays within the wheels.
#[test]
fn specifications_that_cannot_be_met_are_refused_with_the_limit() {
    let mut weak = CoreParams::<f64>::paper();
    weak.max_wheel_torque_nm = Some(3.0);
    let strong = CoreParams::<f64>::paper();
    let mut feeble = CoreParams::<f64>::paper();
    feeble.max_wheel_torque_nm = Some(1e-6);
    let lazy = DesignSpec {
        speed_lag_s: 9.0,
        turn_lag_s: 9.0,
        ..DesignSpec::settling(3.0, 0.5)
    };
    for (what, base, spec, parameter, why) in [
        (
            "slow loops",
            &strong,
            lazy,
            DesignParameter::Settling,
            Why::Lag,
        ),
        (
            "weak wheels",
            &weak,
            DesignSpec::settling(3.0, 0.4),
            DesignParameter::Settling,
            Why::Torque,
        ),
        (
            "no time",
            &feeble,
            DesignSpec::settling(3.0, 0.4),
            DesignParameter::Settling,
            Why::NoTime,
        ),
        (
            "no speed",
            &strong,
            DesignSpec::settling(3.0, 0.0),
            DesignParameter::Speed,
            Why::Below,
        ),
        (
            "damping",
            &strong,
            DesignSpec {
                damping: 1.0,
                ..DesignSpec::settling(3.0, 0.4)
            },
            DesignParameter::Damping,
            Why::Above,
        ),
    ] {
        let error = gains::<f64, Libm>(base, &spec).expect_err(what);
        println!("{what}: {error}");
        assert_eq!((error.parameter, error.why), (parameter, why), "{what}");
        if parameter == DesignParameter::Settling && why != Why::NoTime {
            let had = DesignSpec {
                settling_s: 1.002 * error.limit,
                ..spec
            };
            let core =
                gains::<f64, Libm>(base, &had).unwrap_or_else(|error| panic!("{what}: {error}"));
            if let Some(limit) = base.max_wheel_torque_nm {
                let end = 2.0 * had.settling_s;
                let (_, peak) = drive(
                    &paper_constants(&core),
                    spec.speed,
                    Vector2::new(0.0, 0.5),
                    end,
                );
                let torque = 0.1 * (peak.x / 2.0 + peak.y / 0.5);
                println!("{what}: {torque:.2} of {limit} N m");
                // The linear loop turns further than the sine lets the robot; the force is small but not 0.
                assert!(torque < 1.05 * limit, "{torque}");
            }
        }
    }
}

/// A force that the model does not know moves the parked robot by what was tolerated.
#[test]
fn tolerated_errors_are_met() {
    let mut base = CoreParams::<f64>::paper();
    base.max_wheel_torque_nm = Some(15.0);
    for (force_n, error_m) in [(5.0, 0.046), (5.0, 0.02), (20.0, 0.1)] {
        let tolerance = Tolerance::Steady { force_n, error_m };
        let spec = DesignSpec::for_tolerance::<Libm>(&base, tolerance, 0.4).expect("had");
        let core = gains::<f64, Libm>(
            &CoreParams {
                max_wheel_torque_nm: None,
                ..base
            },
            &spec,
        )
        .expect("had");
        // At rest the velocity loop's force k_c1 v_c is the push, v_c = k₄ A e/(A + e).
        let (a, push) = (
            core.neurons.a,
            force_n / core.parking.k_c1 / core.parking.k4,
        );
        let held = a * push / (a - push);
        println!(
            "{force_n} N, {error_m} m: {:.2} s, held at {held:.4} m",
            spec.settling_s
        );
        assert!((held / error_m - 1.0).abs() < 0.03, "{held}");
    }
    let full =
        DesignSpec::for_tolerance::<Libm>(&base, Tolerance::FullTorque { error_m: 1.0 }, 0.4)
            .expect("had");
    let same = Tolerance::Steady {
        force_n: 300.0,
        error_m: 1.0,
    };
    let same = DesignSpec::for_tolerance::<Libm>(&base, same, 0.4).expect("had");
    assert!((full.settling_s - same.settling_s).abs() < 1e-9);
    let error = DesignSpec::for_tolerance::<Libm>(
        &base,
        Tolerance::Steady {
            force_n: 301.0,
            error_m: 1.0,
        },
        0.4,
    )
    .expect_err("two wheels of 150 N");
    println!("{error}");
    assert_eq!(
        (error.parameter, error.why, error.limit.round()),
        (DesignParameter::SteadyForce, Why::Torque, 300.0)
    );
}

proptest! {
    #![proptest_config(cases(40))]

    /// More time never makes a gain larger.
    #[test]
    fn more_time_never_gives_larger_gains(time in 2.0..40.0, more in 1.01..2.0, damping in 0.6..0.98, speed in 0.1..2.0) {
        let spec = |settling_s: f64| DesignSpec { damping, settling_s, ..DesignSpec::settling(time, speed) };
        let fast = tuned(&spec(time));
        prop_assume!(fast.is_ok());
        let fast = fast.expect("had");
        let slow = tuned(&spec(time * more)).expect("what can be had fast can be had slowly");
        for (slow, fast) in [
            (slow.tracking.k1, fast.tracking.k1),
            (slow.tracking.k2, fast.tracking.k2),
            (slow.tracking.k3, fast.tracking.k3),
            (slow.parking.k4, fast.parking.k4),
            (slow.neurons.a, fast.neurons.a),
        ] {
            prop_assert!(slow <= fast, "{slow} {fast}");
        }
    }
}
