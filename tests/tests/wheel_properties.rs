//! B̄ of Eq. (3) and the torque limit, for drawn wheels.

use controller_core::error::{Field, Problem};
use controller_core::scalar::Scalar;
use controller_core::types::{Twist, WheelTorques, Wrench};
use controller_core::wheels::{WheelGeometry, WheelMap, limit_torques};
use nalgebra::Vector2;
use proptest::prelude::*;
use tests::core_draw::{cases, decades};
use tests::oracle::{Params, robot};
use tests::tolerance::{ALGEBRA, WHEELS_DOUBLE, WHEELS_SINGLE};

/// Two wheels, alike or not, over everything accepted.
fn wheels() -> impl Strategy<Value = [f64; 3]> {
    let radius = || decades(-3.0, 1.0).prop_map(|radius| radius.clamp(1e-3, 10.0));
    let track = decades(-2.0, 2.0).prop_map(|track| track.clamp(1e-2, 100.0));
    (radius(), radius(), track).prop_map(|(right, left, track)| [right, left, track])
}

fn geometry<T: Scalar>([right, left, track]: [f64; 3]) -> WheelGeometry<T> {
    // Rounding to single precision may leave the range by one bit.
    let within = |value: f64, low: f64, high: f64| {
        let rounded = T::from_f64(value);
        if rounded < T::from_f64(low) {
            T::from_f64(low)
        } else if rounded > T::from_f64(high) {
            T::from_f64(high)
        } else {
            rounded
        }
    };
    WheelGeometry {
        radius_right_m: within(right, 1e-3, 10.0),
        radius_left_m: within(left, 1e-3, 10.0),
        track_m: within(track, 1e-2, 100.0),
    }
}

/// Round trip, power and agreement of both constructions, relative to `tolerance`.
fn check_wheels<T: Scalar>(
    lengths: [f64; 3],
    wrench: (f64, f64),
    twist: (f64, f64),
    tolerance: f64,
) -> Result<(), TestCaseError> {
    let f = T::from_f64;
    let map = WheelMap::from_geometry(&geometry::<T>(lengths)).expect("in range");
    let [right, left, track] = lengths;
    let given = Wrench {
        force: f(wrench.0),
        moment: f(wrench.1),
    };
    let twist = Twist::new(f(twist.0), f(twist.1));
    let torques = map.torques(&given);
    let back = map.wrench(&torques);
    let size = wrench.0.abs() + wrench.1.abs() / track;
    prop_assert!((back.force - given.force).to_f64().abs() <= tolerance * size);
    prop_assert!((back.moment - given.moment).to_f64().abs() <= tolerance * size * track);

    let speeds = map.wheel_speeds(&twist);
    let again = map.twist(&speeds);
    let speed = twist.linear.to_f64().abs() + track * twist.angular.to_f64().abs();
    prop_assert!((again.linear - twist.linear).to_f64().abs() <= tolerance * speed);
    prop_assert!((again.angular - twist.angular).to_f64().abs() <= tolerance * speed / track);

    // Virtual work: what the wheels do is what the body feels.
    let at_wheels = (torques.right * speeds.right + torques.left * speeds.left).to_f64();
    let at_body = (given.force * twist.linear + given.moment * twist.angular).to_f64();
    prop_assert!((at_wheels - at_body).abs() <= tolerance * size * speed);

    let to_wrench = [
        [T::ONE / f(right), T::ONE / f(left)],
        [f(track / 2.0) / f(right), -(f(track / 2.0) / f(left))],
    ];
    let same = WheelMap::from_matrix(to_wrench)
        .expect("regular")
        .torques(&given);
    prop_assert!((same.right - torques.right).to_f64().abs() <= tolerance * size * right);
    prop_assert!((same.left - torques.left).to_f64().abs() <= tolerance * size * left);
    Ok(())
}

proptest! {
    #![proptest_config(cases(2000))]

    /// B̄ of Eq. (3): there and back, the same power, and one map however it is given.
    #[test]
    fn wheel_map_inverts_and_conserves_power(
        lengths in wheels(), wrench in (-1e3..1e3, -1e3..1e3), twist in (-10.0..10.0, -10.0..10.0),
    ) {
        check_wheels::<f64>(lengths, wrench, twist, WHEELS_DOUBLE)?;
        check_wheels::<f32>(lengths, wrench, twist, WHEELS_SINGLE)?;
    }

    /// B̄ of Eq. (3) for equal wheels is the oracle's.
    #[test]
    fn wheel_map_is_the_oracles(lengths in wheels(), right in -50.0..50.0, left in -50.0..50.0) {
        let [r, _, l] = lengths;
        let p = Params { r, l, ..Params::recommended() };
        let map = WheelMap::from_geometry(&geometry::<f64>([r, r, l])).expect("in range");
        let found = map.wrench(&WheelTorques { right, left });
        let expected = robot::wheel_map(&p) * Vector2::new(right, left);
        prop_assert!((found.force - expected.x).abs() <= ALGEBRA * 100.0 / r);
        prop_assert!((found.moment - expected.y).abs() <= ALGEBRA * 100.0 * l / r);
    }

    /// One factor for both wheels, never above the limit.
    #[test]
    fn limited_torques_keep_their_ratio(right in -1e4..1e4_f64, left in -1e4..1e4_f64, limit in decades(-6.0, 6.0)) {
        let (limited, is_limited) = limit_torques(WheelTorques { right, left }, limit);
        prop_assert!(limited.right.abs() <= limit && limited.left.abs() <= limit);
        prop_assert_eq!(is_limited, right.abs() > limit || left.abs() > limit);
        let across = limited.right * left - limited.left * right;
        prop_assert!(across.abs() <= ALGEBRA * (right * left).abs().max(1.0));
    }
}

/// A B̄ that cannot be inverted, or is no number, is refused by name.
#[test]
fn singular_wheel_maps_are_refused() {
    for singular in [
        [[1.0, 1.0], [2.0, 2.0]],
        [[0.0; 2]; 2],
        [[0.1, 0.3], [0.2, 0.6]],
        [[1.0, 0.0], [5.0, 0.0]],
    ] {
        let error = WheelMap::<f64>::from_matrix(singular).expect_err("singular");
        assert_eq!(
            (error.field, error.problem),
            (Field::WheelMatrix, Problem::Singular)
        );
        assert!(
            WheelMap::<f32>::from_matrix(singular.map(|row| row.map(|entry| entry as f32)))
                .is_err()
        );
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let error = WheelMap::<f64>::from_matrix([[1.0, 1.0], [bad, -1.0]]).expect_err("no number");
        assert_eq!(
            (error.field, error.problem),
            (Field::WheelMatrix, Problem::NotFinite)
        );
    }
}
