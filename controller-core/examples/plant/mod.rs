//! What the examples drive: an ideal robot on a level floor, Eqs. (1) and (3).

use controller_core::maths::Single;
use controller_core::motion::SaturationPolicy;
use controller_core::robot::{acceleration, pose_rate};
use controller_core::types::WheelSpeeds;
use controller_core::wheels::WheelMap;
use controller_core::{Limits, Measured, Robot, WheelTorques};

/// Limits that suit [`Robot::paper`]: 8 N m at a wheel of 0.1 m are 80 N, 2.7 m/s² for each of the two.
#[allow(dead_code)] // Not every example has its robot from here.
pub const LIMITS: Limits = Limits {
    speed: 1.0,
    turn_rate: 2.0,
    rim_speed: 1.2,
    accel: 0.8,
    brake: 1.0,
    turn_accel: 3.0,
    jerk: 20.0,
    turn_jerk: 40.0,
    wheel_torque_nm: 8.0,
    policy: SaturationPolicy::KeepCurvature,
};

/// A robot, and where it is.
pub struct Plant {
    robot: Robot,
    wheels: WheelMap<f32>,
    /// Pose and twist, exactly.
    pub measured: Measured,
}

impl Plant {
    /// At rest in the origin.
    pub fn new(robot: Robot) -> Result<Self, controller_core::error::ParamError> {
        Ok(Self {
            robot,
            wheels: WheelMap::from_geometry(&robot.wheels)?,
            measured: Measured::default(),
        })
    }

    /// `dt` \[s\] with constant torques, by the midpoint rule.
    pub fn advance(&mut self, torques: &WheelTorques, dt: f32) {
        let accel = acceleration(&self.robot, &self.wheels.wrench(torques));
        let Measured { pose, twist } = &mut self.measured;
        let mut middle = *twist;
        middle.linear += 0.5 * dt * accel.linear;
        middle.angular += 0.5 * dt * accel.angular;
        let mut half_way = *pose;
        half_way.theta += 0.5 * dt * middle.angular;
        let rate = pose_rate::<f32, Single>(&half_way, &middle);
        pose.x += dt * rate.x;
        pose.y += dt * rate.y;
        pose.theta += dt * rate.theta;
        twist.linear += dt * accel.linear;
        twist.angular += dt * accel.angular;
    }

    /// Speeds of the wheels \[rad/s\].
    #[allow(dead_code)] // Only examples with encoders need them.
    pub fn wheel_speeds(&self) -> WheelSpeeds {
        self.wheels.wheel_speeds(&self.measured.twist)
    }
}
