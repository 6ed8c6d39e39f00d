//! Parameters as a controller of either precision gets them.

use controller_core::motion::{Limits, MotionGains};
use controller_core::robot::Robot;
use controller_core::scalar::Scalar;
use controller_core::wheels::WheelGeometry;

pub(crate) fn robot<T: Scalar>(from: &Robot<f64>) -> Robot<T> {
    Robot {
        mass_kg: T::from_f64(from.mass_kg),
        inertia_kg_m2: T::from_f64(from.inertia_kg_m2),
        wheels: wheels(&from.wheels),
    }
}

pub(crate) fn wheels<T: Scalar>(from: &WheelGeometry<f64>) -> WheelGeometry<T> {
    let f = T::from_f64;
    WheelGeometry {
        radius_right_m: f(from.radius_right_m),
        radius_left_m: f(from.radius_left_m),
        track_m: f(from.track_m),
    }
}

pub(crate) fn limits<T: Scalar>(from: &Limits<f64>) -> Limits<T> {
    let f = T::from_f64;
    Limits {
        speed: f(from.speed),
        turn_rate: f(from.turn_rate),
        accel: f(from.accel),
        brake: f(from.brake),
        turn_accel: f(from.turn_accel),
        jerk: f(from.jerk),
        turn_jerk: f(from.turn_jerk),
        wheel_torque_nm: f(from.wheel_torque_nm),
        policy: from.policy,
    }
}

pub(crate) fn gains<T: Scalar>(from: &MotionGains<f64>) -> MotionGains<T> {
    let f = T::from_f64;
    MotionGains {
        decay: f(from.decay),
        along: f(from.along),
        along_bound: f(from.along_bound),
        heading: f(from.heading),
        across: f(from.across),
        slow: f(from.slow),
        approach: f(from.approach),
        approach_brake: f(from.approach_brake),
        speed_loop: f(from.speed_loop),
        turn_loop: f(from.turn_loop),
        disturbance: f(from.disturbance),
        disturbance_share: f(from.disturbance_share),
    }
}
