//! The inputs that ticks are counted on.

use controller_core::paper::params::{Params, ValidParams};
use controller_core::scalar::Scalar;
use controller_core::types::{Accel, Measured, Pose, Twist};

use crate::inputs::Inputs;

/// A kind of inputs.
pub struct Kind {
    /// In tables.
    pub name: &'static str,
    /// Largest pose error \[m\] and \[rad\].
    pub error: (f32, f32),
    /// Turns that the robot's heading is off by, of which the law must not know.
    pub turns: f32,
    /// Largest wheel torque \[N m\].
    pub torque: f32,
    /// Whether every torque, or none, is to be limited; `None` leaves it open.
    pub limited: Option<bool>,
}

/// Ordinary, and what makes a tick longer.
pub const KINDS: [Kind; 4] = [
    Kind {
        name: "ordinary",
        error: (0.1, 1.5),
        turns: 0.0,
        torque: 200.0,
        limited: Some(false),
    },
    Kind {
        name: "wrapped",
        error: (0.1, 1.5),
        turns: 1.0,
        torque: 200.0,
        limited: Some(false),
    },
    Kind {
        name: "saturated",
        error: (0.1, 1.5),
        turns: 0.0,
        torque: 1.0e-4,
        limited: Some(true),
    },
    Kind {
        name: "large",
        error: (5.0, 6.0),
        turns: 0.0,
        torque: 5.0,
        limited: None,
    },
];

/// The paper's robot with the kind's torque limit.
pub fn params<T: Scalar>(kind: &Kind) -> Option<ValidParams<T>> {
    let mut params = Params::<T>::paper();
    params.max_wheel_torque_nm = Some(T::from_f64(f64::from(kind.torque)));
    params.validate().ok()
}

/// Pose, twist and acceleration of a reference.
pub fn reference<T: Scalar>(inputs: &mut Inputs) -> (Pose<T>, Twist<T>, Accel<T>) {
    (
        Pose::new(inputs.real(2.0), inputs.real(2.0), inputs.real(1.5)),
        Twist::new(inputs.real(1.0), inputs.real(1.0)),
        Accel::new(inputs.real(1.0), inputs.real(1.0)),
    )
}

/// A robot near a pose.
pub fn measured<T: Scalar>(inputs: &mut Inputs, near: &Pose<T>, kind: &Kind) -> Measured<T> {
    let (metres, radians) = kind.error;
    let turns = T::from_f64(f64::from(kind.turns)) * (T::PI + T::PI);
    Measured {
        pose: Pose {
            x: near.x + inputs.real(metres),
            y: near.y + inputs.real(metres),
            theta: near.theta + inputs.real(radians) + turns,
        },
        twist: Twist::new(inputs.real(1.0), inputs.real(1.0)),
    }
}
