//! Every parameter of the controller, as it travels.

use serde::{Deserialize, Serialize};

use crate::values::{optional_real, real};

/// What happens to the acceleration neurons at the hand-over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum WireReset {
    /// The torque does not jump.
    #[default]
    TorqueContinuous,
    /// As the paper prints it.
    Printed,
    /// They start from zero.
    Zero,
}

/// The parameters of the controller, unchecked: the receiver validates them before it uses any.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterSet {
    /// kg.
    #[serde(deserialize_with = "real")]
    pub mass: f32,
    /// kg m^2.
    #[serde(deserialize_with = "real")]
    pub inertia: f32,
    /// m.
    #[serde(deserialize_with = "real")]
    pub radius_right: f32,
    /// m.
    #[serde(deserialize_with = "real")]
    pub radius_left: f32,
    /// Full distance of the wheels, m.
    #[serde(deserialize_with = "real")]
    pub track: f32,
    /// Tracking, along the path, 1/s.
    #[serde(deserialize_with = "real")]
    pub k1: f32,
    /// Tracking, across the path, 1/m^2.
    #[serde(deserialize_with = "real")]
    pub k2: f32,
    /// Tracking, heading, rad/s.
    #[serde(deserialize_with = "real")]
    pub k3: f32,
    /// Tracking, speed loop, N s/m.
    #[serde(deserialize_with = "real")]
    pub k_d1: f32,
    /// Tracking, turn-rate loop, N m s.
    #[serde(deserialize_with = "real")]
    pub k_d2: f32,
    /// Parking, along the heading, 1/s.
    #[serde(deserialize_with = "real")]
    pub k4: f32,
    /// Parking, heading, rad/s.
    #[serde(deserialize_with = "real")]
    pub k5: f32,
    /// Parking, speed loop, N s/m.
    #[serde(deserialize_with = "real")]
    pub k_c1: f32,
    /// Parking, turn-rate loop, N m s.
    #[serde(deserialize_with = "real")]
    pub k_c2: f32,
    /// Decay A of the neurons, 1/s.
    #[serde(deserialize_with = "real")]
    pub a: f32,
    /// Upper bound B of the neurons.
    #[serde(deserialize_with = "real")]
    pub b: f32,
    /// Lower bound D of the neurons.
    #[serde(deserialize_with = "real")]
    pub d: f32,
    /// Acceleration neurons at the hand-over.
    pub reset: WireReset,
    /// Largest torque of a wheel, N m; none leaves torques unlimited.
    #[serde(deserialize_with = "optional_real")]
    pub max_wheel_torque: Option<f32>,
    /// Longest accepted time between ticks, s.
    #[serde(deserialize_with = "real")]
    pub max_tick: f32,
}
