//! What may be changed of a base in the field, as it travels and as it is stored.
//!
//! Body, encoders, motors and detectors are the firmware's: whoever changes those builds another robot.

use controller_core::safety::{PolicyParams, Timeout};
use serde::{Deserialize, Serialize};

use super::values::real;

/// The parameters of a base that may be changed in the field, unchecked: the receiver validates them together with those that
/// may not before it uses any.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldParams {
    /// Gains of following and parking.
    pub gains: WireGains,
    /// What the base may do.
    pub limits: WireLimits,
    /// What a calibration run found.
    pub calibration: WireCalibration,
    /// How long what may be missing.
    pub timeouts: WireTimeouts,
    /// What is done about each kind of fault.
    pub policy: PolicyParams,
}

/// As [`controller_core::motion::MotionGains`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireGains {
    /// A: decay of pose neurons and transition offsets, 1/s.
    #[serde(deserialize_with = "real")]
    pub decay: f32,
    /// Along the path, 1/s.
    #[serde(deserialize_with = "real")]
    pub longitudinal: f32,
    /// Largest speed that an error along the path adds, m/s.
    #[serde(deserialize_with = "real")]
    pub longitudinal_bound: f32,
    /// Heading, 1/s.
    #[serde(deserialize_with = "real")]
    pub heading: f32,
    /// Across the path, 1/s^2.
    #[serde(deserialize_with = "real")]
    pub lateral: f32,
    /// Reference speed below which lateral correction fades out, m/s.
    #[serde(deserialize_with = "real")]
    pub slow: f32,
    /// Towards the goal, 1/s.
    #[serde(deserialize_with = "real")]
    pub approach: f32,
    /// Planned deceleration of the approach, m/s^2.
    #[serde(deserialize_with = "real")]
    pub approach_brake: f32,
    /// Bandwidth of the speed loop, 1/s.
    #[serde(deserialize_with = "real")]
    pub speed_loop: f32,
    /// Bandwidth of the turn-rate loop, 1/s.
    #[serde(deserialize_with = "real")]
    pub turn_loop: f32,
    /// Bandwidth of the disturbance estimate, 1/s.
    #[serde(deserialize_with = "real")]
    pub disturbance: f32,
    /// Largest disturbance that is compensated, as a share of what the wheels can.
    #[serde(deserialize_with = "real")]
    pub disturbance_share: f32,
}

/// As [`controller_core::motion::Limits`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireLimits {
    /// m/s.
    #[serde(deserialize_with = "real")]
    pub speed: f32,
    /// rad/s.
    #[serde(deserialize_with = "real")]
    pub turn_rate: f32,
    /// Of either wheel's rim, m/s.
    #[serde(deserialize_with = "real")]
    pub rim_speed: f32,
    /// Away from rest, m/s^2.
    #[serde(deserialize_with = "real")]
    pub accel: f32,
    /// Towards rest, m/s^2.
    #[serde(deserialize_with = "real")]
    pub brake: f32,
    /// rad/s^2.
    #[serde(deserialize_with = "real")]
    pub turn_accel: f32,
    /// m/s^3.
    #[serde(deserialize_with = "real")]
    pub jerk: f32,
    /// rad/s^3.
    #[serde(deserialize_with = "real")]
    pub turn_jerk: f32,
    /// Largest torque of a wheel, N m.
    #[serde(deserialize_with = "real")]
    pub wheel_torque_nm: f32,
    /// Who yields when a wheel cannot serve force and moment.
    pub policy: WireYield,
}

/// As [`controller_core::motion::SaturationPolicy`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WireYield {
    /// Both, by one factor.
    KeepCurvature,
    /// The force.
    TurnFirst,
    /// The moment.
    DriveFirst,
}

/// As [`controller_core::odometry::Calibration`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireCalibration {
    /// On the right wheel's radius.
    #[serde(deserialize_with = "real")]
    pub right: f32,
    /// On the left wheel's radius.
    #[serde(deserialize_with = "real")]
    pub left: f32,
    /// On the distance of the wheels.
    #[serde(deserialize_with = "real")]
    pub track: f32,
}

/// As those of [`controller_core::safety::DetectorParams`], in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WireTimeouts {
    /// Encoders without a reading.
    pub measurement: Timeout,
    /// External poses missing.
    pub pose: Timeout,
    /// Host silent: no frame, or no order where one is due.
    pub command: Timeout,
}
