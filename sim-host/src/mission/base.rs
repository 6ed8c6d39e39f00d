//! The base that drives.

use super::hardware::Hardware;
use crate::import;
use controller_core::error::ParamError;
use controller_core::maths::Libm;
use controller_core::motion::{Limits, MotionGains, MotionParams, SaturationPolicy};
use controller_core::robot::Robot;
use controller_core::safety::PolicyParams;

/// A base: what it is, and what it can do.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSpec {
    /// For people.
    pub name: String,
    /// Mass, inertia, wheels.
    pub robot: Robot<f64>,
    /// Speeds, accelerations, torque.
    pub limits: Limits<f64>,
    /// Gains, if they are not those that follow from the limits.
    pub gains: Option<MotionGains<f64>>,
    /// Motors, battery, encoders, localisation; none for an ideal source of torques and poses.
    pub hardware: Option<Hardware>,
    /// Reaction to each kind of fault.
    pub policy: PolicyParams,
    /// What its owner should change in its file: names that are read for the last time.
    pub notes: Vec<String>,
}

impl Default for BaseSpec {
    /// `30 kg base`: the paper's robot with motors of 15 N m at each wheel, on wheels that never slip.
    /// `bases/paper-30kg.toml` gives the reasons for each limit; it turns more gently, since its floor holds less.
    fn default() -> Self {
        Self {
            name: "30 kg base".to_owned(),
            robot: Robot::paper(),
            limits: Limits {
                speed: 2.5,
                turn_rate: 3.0,
                accel: 1.5,
                brake: 1.5,
                turn_accel: 3.0,
                jerk: 20.0,
                turn_jerk: 40.0,
                wheel_torque_nm: 15.0,
                policy: SaturationPolicy::KeepCurvature,
            },
            gains: None,
            hardware: None,
            policy: PolicyParams::DEFAULT,
            notes: Vec::new(),
        }
    }
}

/// What a reference may use of speed and turn rate, of acceleration, torque and jerk, and of angular
/// acceleration. The rest is for feedback: a lateral error is corrected by turning, whose demand
/// reaches 0.7 of the angular acceleration (`docs/motion.md`), seldom where the path turns hardest.
const SHARE: (f64, f64, f64) = (0.9, 0.75, 0.45);

impl BaseSpec {
    /// The controller's parameters.
    pub fn motion(&self) -> MotionParams<f64> {
        let params = MotionParams::new_with::<Libm>(self.robot, self.limits);
        MotionParams {
            gains: self.gains.unwrap_or(params.gains),
            ..params
        }
    }

    /// Control period \[s\]: the hardware's, or 10 ms.
    pub fn period_s(&self) -> f64 {
        self.hardware.map_or(0.01, |hardware| hardware.period_s)
    }

    /// What is out of range, if anything is.
    ///
    /// # Errors
    /// The first parameter that the core refuses.
    pub fn validate(&self) -> Result<(), ParamError> {
        self.motion().validate().map(|_| ())
    }

    /// Limits for a reference, with room for feedback.
    pub fn reference_limits(&self) -> import::ReferenceLimits {
        let (speed, push, turn) = SHARE;
        let (robot, limits) = (&self.robot, &self.limits);
        let wheels = &robot.wheels;
        import::ReferenceLimits {
            max_speed: speed * limits.speed,
            max_turn_rate: speed * limits.turn_rate,
            max_accel: push * limits.accel,
            max_decel: push * limits.brake,
            max_angular_accel: turn * limits.turn_accel,
            max_lateral: f64::INFINITY,
            max_jerk: push * limits.jerk,
            max_angular_jerk: push * limits.turn_jerk,
            drive: Some(import::DriveLimits {
                wheel_torque: push * limits.wheel_torque_nm,
                // The larger wheel needs more torque for the same push.
                wheel_radius: wheels.radius_right_m.max(wheels.radius_left_m),
                track: wheels.track_m,
                mass: robot.mass_kg,
                inertia: robot.inertia_kg_m2,
            }),
        }
    }
}
