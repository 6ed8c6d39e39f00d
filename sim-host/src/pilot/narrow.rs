//! From the loop's doubles to the controller's numbers and back.
//!
//! Narrowing rounds to nearest, once per quantity. Widening is exact.

use crate::drive::narrow;
use controller_core::maths::Maths;
use controller_core::paper::demand::Demand;
use controller_core::paper::params::{Params, ParkingGains, TrackingGains};
use controller_core::paper::report::{NeuronStates, StepReport};
use controller_core::pose_error::PoseError;
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronParams;
use controller_core::types::{Accel, Measured, Pose, Twist, WheelTorques, Wrench};

/// A pose as the controller gets it.
pub fn pose<T: Scalar>(from: &Pose<f64>) -> Pose<T> {
    Pose {
        x: T::from_f64(from.x),
        y: T::from_f64(from.y),
        theta: T::from_f64(from.theta),
    }
}

fn twist<T: Scalar>(from: &Twist<f64>) -> Twist<T> {
    Twist {
        linear: T::from_f64(from.linear),
        angular: T::from_f64(from.angular),
    }
}

/// A measurement as the controller gets it.
pub fn measured<T: Scalar>(from: &Measured<f64>) -> Measured<T> {
    Measured {
        pose: pose(&from.pose),
        twist: twist(&from.twist),
    }
}

/// A reference sample as the controller gets it; its heading's unit vector is made by the
/// controller's own back end.
pub fn reference<T: Scalar, M: Maths<T>>(from: &Reference<f64>) -> Reference<T> {
    let accel = Accel {
        linear: T::from_f64(from.accel().linear),
        angular: T::from_f64(from.accel().angular),
    };
    Reference::new_with::<M>(pose(from.pose()), twist(from.twist()), accel)
}

/// A demand as the controller gets it.
pub fn demand<T: Scalar, M: Maths<T>>(from: &Demand<f64>) -> Demand<T> {
    match from {
        Demand::Track(sample) => Demand::Track(reference::<T, M>(sample)),
        Demand::HandOver {
            reference: sample,
            goal,
        } => Demand::HandOver {
            reference: reference::<T, M>(sample),
            goal: pose(goal),
        },
        Demand::Park => Demand::Park,
    }
}

/// Parameters as the controller gets them.
pub fn params<T: Scalar>(from: &Params<f64>) -> Params<T> {
    let f = T::from_f64;
    let Params {
        robot,
        tracking,
        parking,
        neurons,
        reset,
        max_wheel_torque_nm,
        max_tick_s,
    } = *from;
    Params {
        robot: narrow::robot(&robot),
        tracking: TrackingGains {
            k1: f(tracking.k1),
            k2: f(tracking.k2),
            k3: f(tracking.k3),
            k_d1: f(tracking.k_d1),
            k_d2: f(tracking.k_d2),
        },
        parking: ParkingGains {
            k4: f(parking.k4),
            k5: f(parking.k5),
            k_c1: f(parking.k_c1),
            k_c2: f(parking.k_c2),
        },
        neurons: NeuronParams {
            a: f(neurons.a),
            b: f(neurons.b),
            d: f(neurons.d),
        },
        reset,
        max_wheel_torque_nm: max_wheel_torque_nm.map(f),
        max_tick_s: f(max_tick_s),
    }
}

/// A wrench, widened without rounding.
pub fn wrench<T: Scalar>(from: &Wrench<T>) -> Wrench<f64> {
    Wrench {
        force: from.force.to_f64(),
        moment: from.moment.to_f64(),
    }
}

/// A report, widened without rounding.
pub fn widen<T: Scalar>(from: &StepReport<T>) -> StepReport<f64> {
    let twist = |t: &Twist<T>| Twist::new(t.linear.to_f64(), t.angular.to_f64());
    let accel = |a: &Accel<T>| Accel::new(a.linear.to_f64(), a.angular.to_f64());
    StepReport {
        phase: from.phase,
        error: PoseError {
            x: from.error.x.to_f64(),
            y: from.error.y.to_f64(),
            theta: from.error.theta.to_f64(),
        },
        neurons: NeuronStates {
            s1: from.neurons.s1.to_f64(),
            s2: from.neurons.s2.to_f64(),
            s3: from.neurons.s3.to_f64(),
            accel: accel(&from.neurons.accel),
        },
        command: twist(&from.command),
        command_rate: accel(&from.command_rate),
        velocity_error: twist(&from.velocity_error),
        bridge: twist(&from.bridge),
        wrench: wrench(&from.wrench),
        torques: WheelTorques {
            right: from.torques.right.to_f64(),
            left: from.torques.left.to_f64(),
        },
        saturated: from.saturated,
    }
}
