//! Gains from a design specification for the law for a real base: met in closed loop, refused where they cannot be, never larger for more time.

use controller_core::maths::{Libm, Single};
use controller_core::motion::{MotionGains, MotionParams, Parking, Task};
use controller_core::tuning::motion::{MotionDesignSpec, gains, margins};
use controller_core::tuning::{
    DesignError, DesignParameter, Why, disturbance_bandwidth, disturbance_damping,
};
use controller_core::types::{Pose, Twist};
use proptest::prelude::*;
use tests::core_draw::cases;
use tests::motion_base::{Base, Body};
use tests::motion_loop::steady;
use tests::stated::{At, Stated};
use tests::tuning_loop::{AS_BELIEVED, BASES, base, drive, settled};

/// Settling time found over time specified: the response is that of the linear loop; an offset of 1 cm at 0.5 m/s is answered
/// by neurons with 1 % less, limits on jerk cost some hundredths of a second.
const MET: f64 = 0.03;

/// The gains of a specification on a base that could turn and drive as it liked.
fn tuned(
    spec: &MotionDesignSpec<f64>,
    base: &MotionParams<f64>,
) -> Result<MotionParams<f64>, DesignError> {
    Ok(MotionParams {
        gains: gains::<f64, Libm>(spec, base)?,
        ..*base
    })
}

/// (across, along, arrival) in closed loop \[s\].
fn times(params: &MotionParams<f64>, settling_s: f64) -> (f64, f64, f64) {
    let (offset, speed) = (0.01, 0.5);
    let start = |x: f64, y: f64| {
        let mut body = Body::at(x, y, 0.0);
        body.twist = Twist::new(speed, 0.0);
        body
    };
    let end = 4.0 * settling_s + 2.0;
    let path = steady(speed, 0.0);
    let across = drive(params, AS_BELIEVED, start(0.0, offset), path, end);
    let along = drive(params, AS_BELIEVED, start(-offset, 0.0), path, end);
    let mut by_feedback = *params;
    by_feedback.arrival.parking = Parking::Feedback;
    let park = |_| Task::Park(Pose::default());
    let arrival = drive(
        &by_feedback,
        AS_BELIEVED,
        Body::at(-0.05, 0.0, 0.0),
        park,
        end,
    );
    (
        settled(&across, 0.1 * offset, |now| now.error.1),
        settled(&along, 0.1 * offset, |now| now.error.0),
        settled(&arrival, 0.1 * 0.05, |now| now.error.0),
    )
}

/// Every specification on every base is met.
#[test]
fn specified_times_are_met() {
    let mut worst = 0.0_f64;
    for name in BASES {
        let base = base(name);
        for (settling_s, damping) in [
            (2.5, 0.8),
            (3.0, 0.65),
            (3.5, 0.95),
            (6.0, 0.8),
            (15.0, 0.8),
        ] {
            let spec = MotionDesignSpec {
                damping,
                ..MotionDesignSpec::settling(settling_s)
            };
            let params =
                tuned(&spec, &base).unwrap_or_else(|error| panic!("{name}, {damping}: {error}"));
            let (across, along, arrival) = times(&params, settling_s);
            println!(
                "{name}: specified {settling_s} s, {damping}: across {across:.2} along {along:.2} arrival {arrival:.2}"
            );
            for found in [across, along, arrival] {
                worst = worst.max((found / settling_s - 1.0).abs());
                assert!(
                    (found / settling_s - 1.0).abs() < MET,
                    "{name}: {found} for {settling_s}"
                );
            }
            let found = margins::<f64, Libm>(&params.gains);
            assert!(
                (found.settling_s / settling_s - 1.0).abs() < 0.01,
                "{found:?}"
            );
            assert!((found.lateral.damping - damping).abs() < 0.01, "{found:?}");
        }
    }
    let mut page = Stated::of("docs/tuning.md");
    page.exactly(At::Phrase("within # % (`tuning_motion.rs"), &[1e2 * worst]);
}

/// Every refusal names parameter, value, limit and reason, and the limit can be had while a bit less cannot.
#[test]
fn specifications_that_cannot_be_met_are_refused_with_the_limit() {
    let lab = base("lab-10kg");
    let weak = Base::WEAK.exact();
    let feeble = {
        let mut params = lab;
        params.limits.wheel_torque_nm = 0.1;
        params
    };
    // What it can turn and accelerate is no limit.
    let agile = {
        let mut params = lab;
        (params.limits.turn_accel, params.limits.wheel_torque_nm) = (200.0, 50.0);
        (params.limits.accel, params.limits.brake) = (20.0, 20.0);
        params.gains.decay = 10.0;
        params
    };
    let with = MotionDesignSpec::settling;
    for (what, base, spec, parameter, why) in [
        (
            "too fast for the neurons",
            &agile,
            with(0.5),
            DesignParameter::Settling,
            Why::Neurons,
        ),
        (
            "weak base",
            &weak,
            with(3.0),
            DesignParameter::Settling,
            Why::TurnAccel,
        ),
        (
            "feeble wheels",
            &feeble,
            with(2.5),
            DesignParameter::Settling,
            Why::Torque,
        ),
        (
            "arrival",
            &agile,
            MotionDesignSpec {
                arrival_s: 0.5,
                pose_delay_s: 0.0,
                ..with(3.0)
            },
            DesignParameter::Arrival,
            Why::Neurons,
        ),
        (
            "late poses",
            &lab,
            MotionDesignSpec {
                pose_delay_s: 0.6,
                ..with(3.0)
            },
            DesignParameter::PoseDelay,
            Why::Delay,
        ),
        (
            "late torque",
            &lab,
            MotionDesignSpec {
                torque_delay_s: 0.2,
                ..with(3.0)
            },
            DesignParameter::TorqueDelay,
            Why::Delay,
        ),
        (
            "damping",
            &lab,
            MotionDesignSpec {
                damping: 0.3,
                ..with(3.0)
            },
            DesignParameter::Damping,
            Why::Below,
        ),
        (
            "not a number",
            &lab,
            with(f64::NAN),
            DesignParameter::Settling,
            Why::Above,
        ),
    ] {
        let error = gains::<f64, Libm>(&spec, base).expect_err(what);
        println!("{what}: {error}");
        assert_eq!((error.parameter, error.why), (parameter, why), "{what}");
        let text = error.to_string();
        assert!(text.contains(parameter.name()) && text.contains(&format!("{:.4}", error.limit)));
        let had = match parameter {
            _ if error.why == Why::Above => with(error.limit),
            DesignParameter::Settling => MotionDesignSpec {
                settling_s: 1.01 * error.limit,
                arrival_s: 60.0,
                ..spec
            },
            DesignParameter::Arrival => MotionDesignSpec {
                arrival_s: 1.01 * error.limit,
                ..spec
            },
            DesignParameter::PoseDelay => MotionDesignSpec {
                pose_delay_s: 0.99 * error.limit,
                ..spec
            },
            DesignParameter::TorqueDelay => MotionDesignSpec {
                torque_delay_s: 0.99 * error.limit,
                ..spec
            },
            _ => MotionDesignSpec {
                damping: error.limit,
                settling_s: 3.0,
                ..spec
            },
        };
        let mut page = Stated::of("docs/tuning.md");
        match what {
            "too fast for the neurons" => page.exactly(
                At::Phrase("as fast as A lets it be: with 10/s, # s across"),
                &[error.limit],
            ),
            "arrival" => page.exactly(At::Phrase("across and # s to a goal"), &[error.limit]),
            "weak base" => page.exactly(
                At::Phrase("The weak base (0.28 rad/s²) gets no less than # s"),
                &[error.limit],
            ),
            _ => {}
        }
        let again = gains::<f64, Libm>(&had, base);
        assert!(
            again.is_ok(),
            "{what}: the limit {} is refused too: {again:?}",
            error.limit
        );
    }
}

/// Noise raises the speed below which lateral correction fades, and nothing else.
#[test]
fn noise_only_raises_the_slow_speed() {
    let lab = base("lab-10kg");
    let quiet = MotionDesignSpec::settling(3.0);
    let noisy = MotionDesignSpec {
        pose_noise_m: 0.01,
        ..quiet
    };
    let exact = gains::<f64, Libm>(&quiet, &lab).expect("had");
    let found = gains::<f64, Libm>(&noisy, &lab).expect("had");
    // c σ/(2 k₃ v_f) is 0.03 rad.
    let heading_noise = found.lateral * 0.01 / (2.0 * found.heading * found.slow);
    assert!((heading_noise - 0.03).abs() < 1e-9, "{heading_noise}");
    assert!(found.slow > exact.slow);
    assert_eq!(
        MotionGains {
            slow: exact.slow,
            ..found
        },
        exact
    );
}

/// λ² + κλ + κ w_d by hand.
#[test]
fn disturbance_bandwidth_gives_its_damping() {
    assert!((disturbance_bandwidth(4.0, 1.0) - 1.0_f64).abs() < 1e-12);
    for damping in [0.5, 0.7, 1.0, 2.0] {
        let estimate = disturbance_bandwidth(5.0, damping);
        let back = disturbance_damping::<f64, Libm>(5.0, estimate);
        assert!((back - damping).abs() < 1e-12);
    }
}

proptest! {
    #![proptest_config(cases(60))]

    /// More time never makes a gain larger, more lag never a loop; single precision agrees.
    #[test]
    fn more_time_never_gives_larger_gains(
        shorter in 2.5..40.0_f64, more in 1.01..2.0_f64, damping in 0.6..0.98, lag in 0.05..0.5,
    ) {
        let lab = base("lab-10kg");
        let spec = |time: f64, lag: f64| MotionDesignSpec {
            damping,
            turn_lag_s: lag,
            speed_lag_s: lag,
            ..MotionDesignSpec::settling(time)
        };
        let time = (shorter * more).min(60.0);
        let fast = gains::<f64, Libm>(&spec(shorter, lag), &lab);
        prop_assume!(fast.is_ok());
        let fast = fast.expect("had");
        let slow = gains::<f64, Libm>(&spec(time, lag), &lab);
        // What can be had fast can be had slowly.
        let slow = slow.expect("had");
        for (slow, fast) in [
            (slow.longitudinal, fast.longitudinal),
            (slow.heading, fast.heading),
            (slow.lateral, fast.lateral),
            (slow.approach, fast.approach),
        ] {
            prop_assert!(slow <= fast, "{slow} {fast}");
        }
        if let Ok(soft) = gains::<f64, Libm>(&spec(time, 2.0 * lag), &lab) {
            prop_assert!(soft.speed_loop < slow.speed_loop && soft.turn_loop < slow.turn_loop);
        }
        let single = Base::STANDARD.params::<f32, Single>();
        let spec = MotionDesignSpec {
            damping: damping as f32,
            ..MotionDesignSpec::settling(time as f32)
        };
        let single = gains::<f32, Single>(&spec, &single).expect("had");
        let double = Base::STANDARD.exact();
        let double = gains::<f64, Libm>(&MotionDesignSpec { damping, ..MotionDesignSpec::settling(time) }, &double).expect("had");
        // 800 steps of single precision.
        prop_assert!((f64::from(single.lateral) / double.lateral - 1.0).abs() < 0.01);
        prop_assert!((f64::from(single.longitudinal) / double.longitudinal - 1.0).abs() < 0.01);
    }
}
