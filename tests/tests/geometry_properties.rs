//! Robot, angles, pose errors and reference, for drawn postures, against the oracle.

use controller_core::angle::wrap;
use controller_core::maths::Libm;
use controller_core::pose_error::{pose_error, pose_error_rate};
use controller_core::reference::ConstantTwist;
use controller_core::robot::{acceleration, constraint_residual, pose_rate, wrench_for};
use controller_core::scalar::Scalar;
use controller_core::types::{Accel, Pose, Twist, Wrench};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use tests::core_draw::{cases, decades, finite};
use tests::core_params::{core_params, pose};
use tests::oracle::{Params, Reference, Reset, posture, robot};
use tests::tolerance::{ALGEBRA, CONSTANT_TWIST, ERROR_DIFFERENCE, WRAP, WRAP_FAR};

/// The angle up to whole turns, from the library's exact reduction.
fn congruent(wrapped: f64, angle: f64) -> f64 {
    let (s, c) = wrapped.sin_cos();
    let (sine, cosine) = angle.sin_cos();
    (s - sine).hypot(c - cosine)
}

fn check_wrap<T: Scalar>(angle: f64, tolerance: f64) -> Result<(), TestCaseError> {
    let given = T::from_f64(angle);
    let wrapped = wrap(given);
    prop_assert!(
        wrapped > -T::PI && wrapped <= T::PI,
        "{wrapped:?} of {given:?}"
    );
    prop_assert_eq!(wrap(wrapped), wrapped, "idempotent");
    if given > -T::PI && given <= T::PI {
        prop_assert_eq!(
            wrapped.to_f64().to_bits(),
            given.to_f64().to_bits(),
            "unchanged inside"
        );
    }
    let miss = congruent(wrapped.to_f64(), given.to_f64());
    prop_assert!(
        miss <= tolerance,
        "{given:?} wraps to {wrapped:?}, off by {miss:e}"
    );
    Ok(())
}

proptest! {
    #![proptest_config(cases(2000))]

    /// An angle of any size comes into (-π, π].
    #[test]
    fn wrap_is_right_for_any_finite_angle(small in -100.0..100.0, large in -1e6..1e6_f64, double in finite::<f64>(), single in finite::<f32>()) {
        for angle in [small, large, double, single] {
            let far = angle.abs() >= 1e5;
            check_wrap::<f64>(angle, if far { WRAP_FAR } else { WRAP.0 * (2.0 + angle.abs()) })?;
        }
        for angle in [small, single] {
            check_wrap::<f32>(angle, WRAP.1)?;
        }
    }

    /// Eq. (7) and Eq. (8) as the oracle's matrices say, and Eq. (9) as their rate.
    #[test]
    fn pose_error_is_the_oracles_and_its_rate_is_its_rate(
        q in prop::array::uniform3(-5.0..5.0_f64), q_r in prop::array::uniform3(-5.0..5.0_f64),
        twist in prop::array::uniform2(-2.0..2.0_f64), twist_r in prop::array::uniform2(-2.0..2.0_f64),
    ) {
        let (q, q_r) = (Vector3::from(q), Vector3::from(q_r));
        let (twist, twist_r) = (Vector2::from(twist), Vector2::from(twist_r));
        let core = |q_r: Vector3<f64>, q: Vector3<f64>| {
            let e = pose_error::<f64, Libm>(&pose(&q_r), &pose(&q));
            Vector3::new(e.x, e.y, e.theta)
        };
        let e = core(q_r, q);
        let across = e - posture::error(&q_r, &q);
        prop_assert!(across.xy().amax() <= ALGEBRA);
        prop_assert!(posture::wrap(across.z).abs() <= ALGEBRA);
        prop_assert!(e.z > -PI && e.z <= PI, "e_θ = {}", e.z);

        let (h, s, c) = (1e-6, robot::posture_rate(&q, &twist), robot::posture_rate(&q_r, &twist_r));
        // Second-order steps along either motion: a circle's chord is off by h³ only.
        let turned = |q: &Vector3<f64>, rate: &Vector3<f64>, w: f64, h: f64| {
            let curved = Vector3::new(-rate.y, rate.x, 0.0) * (w * h * h / 2.0);
            q + h * rate + curved
        };
        let ends = [h, -h].map(|h| core(turned(&q_r, &c, twist_r.y, h), turned(&q, &s, twist.y, h)));
        let mut difference = ends[0] - ends[1];
        difference.z = posture::wrap(difference.z);
        let at = pose_error::<f64, Libm>(&pose(&q_r), &pose(&q));
        let rate = pose_error_rate(
            &at, at.theta.sin_cos(), &Twist::new(twist_r.x, twist_r.y), &Twist::new(twist.x, twist.y),
        );
        let rate = Vector3::new(rate.x, rate.y, rate.theta);
        prop_assert!((difference / (2.0 * h) - rate).amax() <= ERROR_DIFFERENCE);
        prop_assert!((rate - posture::error_rate(&e, &twist, &twist_r)).amax() <= ALGEBRA);
    }

    /// Eq. (1) never leaves the constraint of Eq. (2); Eq. (3) is the oracle's, there and back.
    #[test]
    fn model_is_the_oracles_and_keeps_the_constraint(
        q in prop::array::uniform3(-5.0..5.0_f64), v in -2.0..2.0_f64, w in -2.0..2.0_f64, skid in -1.0..1.0_f64,
    ) {
        let q = Vector3::from(q);
        let (at, twist) = (pose::<f64>(&q), Twist::new(v, w));
        let rate = pose_rate::<f64, Libm>(&at, &twist);
        let expected = robot::posture_rate(&q, &Vector2::new(v, w));
        prop_assert!((Vector3::new(rate.x, rate.y, rate.theta) - expected).amax() <= ALGEBRA);
        prop_assert!(constraint_residual::<f64, Libm>(&at, &rate).abs() <= ALGEBRA);
        let (sine, cosine) = q.z.sin_cos();
        let sliding = Pose::new(rate.x - skid * sine, rate.y + skid * cosine, rate.theta);
        prop_assert!((constraint_residual::<f64, Libm>(&at, &sliding) - skid).abs() <= ALGEBRA);

        let p = Params::recommended();
        let core = core_params::<f64>(&p, Reset::Corrected).robot;
        let found = acceleration(&core, &Wrench { force: v, moment: w });
        let expected = robot::acceleration(&p, &Vector2::new(v, w));
        prop_assert!((found.linear - expected.x).abs() <= ALGEBRA);
        prop_assert!((found.angular - expected.y).abs() <= ALGEBRA);
        let back = wrench_for(&core, &Accel::new(found.linear, found.angular));
        prop_assert!((back.force - v).abs() <= ALGEBRA && (back.moment - w).abs() <= ALGEBRA);
    }
}

proptest! {
    #![proptest_config(cases(100))]

    /// Eq. (6) in closed form is Eq. (6) integrated, through w_r = 0 as well.
    #[test]
    fn constant_twist_is_the_integral(
        start in prop::array::uniform3(-3.0..3.0_f64), v in -2.0..2.0_f64, t in 0.0..10.0_f64,
        w in prop_oneof![-3.0..3.0_f64, Just(0.0), decades(-12.0, -1.0), decades(-12.0, -1.0).prop_map(|w| -w)],
    ) {
        let path = ConstantTwist { start: pose::<f64>(&Vector3::from(start)), twist: Twist::new(v, w) };
        let found = path.at::<Libm>(t);
        let expected = Reference::steady(start, v, w).posture(t);
        let difference = Vector3::new(found.pose().x, found.pose().y, found.pose().theta) - expected;
        prop_assert!(difference.amax() <= CONSTANT_TWIST, "{difference}");
        prop_assert_eq!(*found.twist(), path.twist);
        prop_assert_eq!(*found.accel(), Accel::default());
    }
}

/// The ends of the circle, and what is no angle.
#[test]
fn wrap_names_half_a_turn_pi() {
    assert!(wrap(f64::NAN).is_nan() && wrap(f64::INFINITY).is_nan());
    assert_eq!((wrap(PI), wrap(-PI)), (PI, PI));
    assert!(
        wrap(TAU).abs() <= WRAP_FAR,
        "the double nearest to a whole turn"
    );
}
