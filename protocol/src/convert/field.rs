//! What may be changed in the field, out of all parameters and back into them.

use controller_core::base::BaseParams;
use controller_core::localiser::LocaliserParams;
use controller_core::motion::{Limits, MotionGains, MotionParams, SaturationPolicy};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::safety::DetectorParams;

use crate::{FieldParams, WireCalibration, WireGains, WireLimits, WireTimeouts, WireYield};

impl From<&BaseParams<f32>> for FieldParams {
    fn from(params: &BaseParams<f32>) -> Self {
        let MotionParams { gains, limits, .. } = &params.motion;
        let calibration = &params.localiser.odometry.calibration;
        let detectors = &params.detectors;
        Self {
            gains: WireGains {
                decay: gains.decay,
                longitudinal: gains.longitudinal,
                longitudinal_bound: gains.longitudinal_bound,
                heading: gains.heading,
                lateral: gains.lateral,
                slow: gains.slow,
                approach: gains.approach,
                approach_brake: gains.approach_brake,
                speed_loop: gains.speed_loop,
                turn_loop: gains.turn_loop,
                disturbance: gains.disturbance,
                disturbance_share: gains.disturbance_share,
            },
            limits: WireLimits {
                speed: limits.speed,
                turn_rate: limits.turn_rate,
                rim_speed: limits.rim_speed,
                accel: limits.accel,
                brake: limits.brake,
                turn_accel: limits.turn_accel,
                jerk: limits.jerk,
                turn_jerk: limits.turn_jerk,
                wheel_torque_nm: limits.wheel_torque_nm,
                policy: match limits.policy {
                    SaturationPolicy::KeepCurvature => WireYield::KeepCurvature,
                    SaturationPolicy::TurnFirst => WireYield::TurnFirst,
                    SaturationPolicy::DriveFirst => WireYield::DriveFirst,
                },
            },
            calibration: WireCalibration {
                right: calibration.right,
                left: calibration.left,
                track: calibration.track,
            },
            timeouts: WireTimeouts {
                measurement: detectors.measurement,
                pose: detectors.pose,
                command: detectors.command,
            },
            policy: params.policy,
        }
    }
}

impl FieldParams {
    /// All parameters: these, and the rest from `base`. Nothing is checked.
    pub fn apply(&self, base: &BaseParams<f32>) -> BaseParams<f32> {
        let Self {
            gains,
            limits,
            calibration,
            timeouts,
            policy,
        } = self;
        BaseParams {
            motion: MotionParams {
                gains: MotionGains {
                    decay: gains.decay,
                    longitudinal: gains.longitudinal,
                    longitudinal_bound: gains.longitudinal_bound,
                    heading: gains.heading,
                    lateral: gains.lateral,
                    slow: gains.slow,
                    approach: gains.approach,
                    approach_brake: gains.approach_brake,
                    speed_loop: gains.speed_loop,
                    turn_loop: gains.turn_loop,
                    disturbance: gains.disturbance,
                    disturbance_share: gains.disturbance_share,
                },
                limits: Limits {
                    speed: limits.speed,
                    turn_rate: limits.turn_rate,
                    rim_speed: limits.rim_speed,
                    accel: limits.accel,
                    brake: limits.brake,
                    turn_accel: limits.turn_accel,
                    jerk: limits.jerk,
                    turn_jerk: limits.turn_jerk,
                    wheel_torque_nm: limits.wheel_torque_nm,
                    policy: match limits.policy {
                        WireYield::KeepCurvature => SaturationPolicy::KeepCurvature,
                        WireYield::TurnFirst => SaturationPolicy::TurnFirst,
                        WireYield::DriveFirst => SaturationPolicy::DriveFirst,
                    },
                },
                ..base.motion
            },
            localiser: LocaliserParams {
                odometry: OdometryParams {
                    calibration: Calibration {
                        right: calibration.right,
                        left: calibration.left,
                        track: calibration.track,
                    },
                    ..base.localiser.odometry
                },
                ..base.localiser
            },
            detectors: DetectorParams {
                measurement: timeouts.measurement,
                pose: timeouts.pose,
                command: timeouts.command,
                ..base.detectors
            },
            policy: *policy,
            ..*base
        }
    }
}
