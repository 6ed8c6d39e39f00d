//! The base that drives.

use super::hardware::Hardware;
use crate::import;
use controller_core::error::ParamError;
use controller_core::maths::Libm;
use controller_core::motion::{Limits, MotionGains, MotionParams, REFERENCE_TURN_SHARE};
use controller_core::robot::Robot;
use controller_core::safety::PolicyParams;
use controller_core::safety::supervisor::IdleOutput;

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
    /// What the wheels do while nothing is ordered.
    pub idle_output: IdleOutput,
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
            limits: Limits::PAPER,
            gains: None,
            hardware: None,
            policy: PolicyParams::DEFAULT,
            idle_output: IdleOutput::Release,
            notes: Vec::new(),
        }
    }
}

/// What a reference may use of the base's limits; the rest is for feedback.
struct Shares {
    /// Of speed and turn rate: what is behind catches up with the rest.
    speed: f64,
    /// Of acceleration and braking.
    accel: f64,
    /// Of the angular acceleration. A lateral error is corrected by turning, whose demand reaches
    /// 0.7 of it (`docs/motion.md`), seldom where the path turns hardest: with 0.7 a 30 kg base that
    /// starts 0.15 m beside a winding path no longer reaches it on the way.
    turn_accel: f64,
    /// Of the wheels' torque: as much as commands get.
    torque: f64,
    /// Of the rates of both accelerations: a tick's change of feedback has the rest.
    jerk: f64,
}

const SHARE: Shares = Shares {
    speed: 0.95,
    accel: 0.85,
    turn_accel: REFERENCE_TURN_SHARE,
    torque: 0.75,
    jerk: 0.75,
};

impl BaseSpec {
    /// The controller's parameters on a source of torques without motors.
    pub fn motion(&self) -> MotionParams<f64> {
        let params = MotionParams::for_period::<Libm>(self.robot, self.limits, self.period_s());
        MotionParams {
            gains: self.gains.unwrap_or(params.gains),
            ..params
        }
    }

    /// The robot as its wheels feel it: with the rotors of its motors.
    pub fn robot_with_rotors(&self) -> Robot<f64> {
        let hardware = self.hardware.as_ref();
        let motor = hardware.and_then(|hardware| hardware.drivers.motor());
        let inertia = motor.map_or(0.0, |motor| motor.rotor_at_wheel_kg_m2());
        self.robot.with_wheel_inertia(inertia)
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

    /// Radius of the smaller wheel, which turns fastest for a speed of the base \[m\].
    pub fn smaller_radius_m(&self) -> f64 {
        let wheels = &self.robot.wheels;
        wheels.radius_right_m.min(wheels.radius_left_m)
    }

    /// Limits for a reference, with room for feedback.
    pub fn reference_limits(&self) -> import::ReferenceLimits {
        let (robot, limits) = (&self.robot_with_rotors(), &self.limits);
        let wheels = &robot.wheels;
        import::ReferenceLimits {
            max_speed: SHARE.speed * limits.speed,
            max_turn_rate: SHARE.speed * limits.turn_rate,
            max_accel: SHARE.accel * limits.accel,
            max_decel: SHARE.accel * limits.brake,
            max_angular_accel: SHARE.turn_accel * limits.turn_accel,
            max_lateral: f64::INFINITY,
            max_jerk: SHARE.jerk * limits.jerk,
            max_angular_jerk: SHARE.jerk * limits.turn_jerk,
            drive: Some(import::DriveLimits {
                wheel_torque: SHARE.torque * limits.wheel_torque_nm,
                rim_speed: SHARE.speed * limits.rim_speed,
                // The larger wheel needs more torque for the same push.
                wheel_radius: wheels.radius_right_m.max(wheels.radius_left_m),
                track: wheels.track_m,
                mass: robot.mass_kg,
                inertia: robot.inertia_kg_m2,
            }),
        }
    }
}
