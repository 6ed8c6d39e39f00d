//! The oracle's constants and vectors in the core's types, for either scalar.

use controller_core::maths::{Libm, Maths};
use controller_core::paper::params::Reset as CoreReset;
use controller_core::paper::params::{
    Params as CoreParams, ParkingGains, TrackingGains, ValidParams,
};
use controller_core::reference::Reference as Sample;
use controller_core::robot::Robot;
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronParams;
use controller_core::types::{Accel, Measured, Pose, Twist};
use controller_core::wheels::WheelGeometry;
use nalgebra::{Vector2, Vector3};

use crate::oracle::laws::Target;
use crate::oracle::{Params, Reset};

/// Longest tick that the runs of these tests use \[s\].
const MAX_TICK_S: f64 = 1.0;

/// The same constants as the core reads them, without a torque limit.
pub fn core_params<T: Scalar>(p: &Params, reset: Reset) -> CoreParams<T> {
    let f = T::from_f64;
    CoreParams {
        robot: Robot {
            mass_kg: f(p.m),
            inertia_kg_m2: f(p.inertia),
            wheels: WheelGeometry {
                radius_right_m: f(p.r),
                radius_left_m: f(p.r),
                track_m: f(p.l),
            },
        },
        tracking: TrackingGains {
            k1: f(p.k1),
            k2: f(p.k2),
            k3: f(p.k3),
            k_d1: f(p.kd1),
            k_d2: f(p.kd2),
        },
        parking: ParkingGains {
            k4: f(p.k4),
            k5: f(p.k5),
            k_c1: f(p.kc1),
            k_c2: f(p.kc2),
        },
        neurons: NeuronParams {
            a: f(p.a),
            b: f(p.b),
            d: f(p.d),
        },
        reset: match reset {
            Reset::Corrected => CoreReset::TorqueContinuous,
            Reset::Printed => CoreReset::Printed,
            Reset::Zero => CoreReset::Zero,
        },
        max_wheel_torque_nm: None,
        max_tick_s: f(MAX_TICK_S),
    }
}

/// [`core_params`], accepted.
pub fn validated<T: Scalar>(p: &Params, reset: Reset) -> ValidParams<T> {
    core_params(p, reset)
        .validate()
        .expect("the oracle's constants are in the core's ranges")
}

/// A posture.
pub fn pose<T: Scalar>(q: &Vector3<f64>) -> Pose<T> {
    Pose::new(T::from_f64(q.x), T::from_f64(q.y), T::from_f64(q.z))
}

/// A posture and (v, w), as a base measures them.
pub fn measured<T: Scalar>(q: &Vector3<f64>, twist: &Vector2<f64>) -> Measured<T> {
    Measured {
        pose: pose(q),
        twist: Twist::new(T::from_f64(twist.x), T::from_f64(twist.y)),
    }
}

/// A reference posture and its motion.
pub fn sample<T: Scalar>(q_r: &Vector3<f64>, target: &Target) -> Sample<T>
where
    Libm: Maths<T>,
{
    let Target { twist, accel } = target;
    Sample::new_with::<Libm>(
        pose(q_r),
        Twist::new(T::from_f64(twist.x), T::from_f64(twist.y)),
        Accel::new(T::from_f64(accel.x), T::from_f64(accel.y)),
    )
}

/// Every copy of `good` with one of its seven numbers replaced by `bad`.
pub fn spoiled<T: Scalar>(good: &Sample<T>, bad: T) -> Vec<Sample<T>>
where
    Libm: Maths<T>,
{
    let (pose, twist, accel) = (*good.pose(), *good.twist(), *good.accel());
    let with = |pose, twist, accel| Sample::new_with::<Libm>(pose, twist, accel);
    vec![
        with(Pose { x: bad, ..pose }, twist, accel),
        with(Pose { y: bad, ..pose }, twist, accel),
        with(Pose { theta: bad, ..pose }, twist, accel),
        with(
            pose,
            Twist {
                linear: bad,
                ..twist
            },
            accel,
        ),
        with(
            pose,
            Twist {
                angular: bad,
                ..twist
            },
            accel,
        ),
        with(
            pose,
            twist,
            Accel {
                linear: bad,
                ..accel
            },
        ),
        with(
            pose,
            twist,
            Accel {
                angular: bad,
                ..accel
            },
        ),
    ]
}
