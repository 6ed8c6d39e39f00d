//! What the base can do.

use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::range::{check_ranges, clamp, larger};
use crate::scalar::Scalar;
use crate::types::Twist;

/// Share of the wheels' torque that the command may use; the rest is the velocity loop's.
const COMMAND_SHARE: f64 = 0.75;

/// Limits of a base, each positive and finite. The controller stays inside all of them at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits<T = f32> {
    /// Largest speed, forward or backward \[m/s\], 1e-3 to 100.
    pub speed: T,
    /// Largest turn rate \[rad/s\], 1e-3 to 100.
    pub turn_rate: T,
    /// Largest speed of either wheel's rim, |v| + l |w|/2 \[m/s\], 1e-3 to 1e3: what the motors reach on a battery that is low.
    /// [`Limits::least_rim_speed`] unless you know better.
    pub rim_speed: T,
    /// Largest acceleration away from rest \[m/s²\], 1e-3 to 1e3.
    pub accel: T,
    /// Largest deceleration towards rest \[m/s²\], 1e-3 to 1e3.
    pub brake: T,
    /// Largest angular acceleration \[rad/s²\], 1e-3 to 1e4.
    pub turn_accel: T,
    /// Largest rate of change of the fed-forward acceleration \[m/s³\], 1e-2 to 1e6.
    pub jerk: T,
    /// The same for the angular acceleration \[rad/s³\], 1e-2 to 1e6.
    pub turn_jerk: T,
    /// Largest torque of either wheel \[N m\], 1e-6 to 1e6.
    pub wheel_torque_nm: T,
    /// Who yields where both wheels cannot be served.
    pub policy: SaturationPolicy,
}

cast!(
    Limits {
        speed,
        turn_rate,
        rim_speed,
        accel,
        brake,
        turn_accel,
        jerk,
        turn_jerk,
        wheel_torque_nm,
    } keeps policy
);

/// Who yields when force and moment together ask too much of a wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SaturationPolicy {
    /// Both, by one factor: the ratio of force to moment, and so the curvature, is kept.
    #[default]
    KeepCurvature,
    /// The force: the robot turns as asked and drives with what is left.
    TurnFirst,
    /// The moment: the robot drives as asked and turns with what is left.
    DriveFirst,
}

impl Limits<f64> {
    /// What suits the paper's robot with motors of 15 N m at each wheel, on wheels that never slip.
    pub const PAPER: Self = Self {
        speed: 2.5,
        turn_rate: 3.0,
        rim_speed: 2.5,
        accel: 1.5,
        brake: 1.5,
        turn_accel: 3.0,
        jerk: 20.0,
        turn_jerk: 40.0,
        wheel_torque_nm: 15.0,
        policy: SaturationPolicy::KeepCurvature,
    };
}

impl<T: Scalar> Limits<T> {
    /// The rim speed that a largest speed and a largest turn rate need, one at a time, on a track of l \[m\]:
    /// max(v, l w/2) \[m/s\]. The [`rim_speed`](Self::rim_speed) of motors that are made for either and not for both.
    pub fn least_rim_speed(speed: T, turn_rate: T, track_m: T) -> T {
        larger(speed, T::HALF * track_m * turn_rate)
    }

    /// What a command may use of a wheel's torque \[N m\].
    pub(crate) fn command_torque_nm(&self) -> T {
        T::from_f64(COMMAND_SHARE) * self.wheel_torque_nm
    }

    pub(crate) fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::MaxSpeed, self.speed, 1.0e-3, 100.0),
            (Field::MaxTurnRate, self.turn_rate, 1.0e-3, 100.0),
            (Field::MaxRimSpeed, self.rim_speed, 1.0e-3, 1.0e3),
            (Field::MaxAccel, self.accel, 1.0e-3, 1.0e3),
            (Field::MaxBrake, self.brake, 1.0e-3, 1.0e3),
            (Field::MaxTurnAccel, self.turn_accel, 1.0e-3, 1.0e4),
            (Field::MaxJerk, self.jerk, 1.0e-2, 1.0e6),
            (Field::MaxTurnJerk, self.turn_jerk, 1.0e-2, 1.0e6),
            (Field::MaxWheelTorque, self.wheel_torque_nm, 1.0e-6, 1.0e6),
        ]
    }

    /// A twist within the limits of a base with this track \[m\]: each axis by itself, then both by one factor, so that no rim is
    /// faster than it may be and the curvature stays.
    pub fn reachable(&self, twist: &Twist<T>, track_m: T) -> Twist<T> {
        let linear = clamp(twist.linear, self.speed);
        let angular = clamp(twist.angular, self.turn_rate);
        let rim = rim_speed(linear, angular, T::HALF * track_m);
        if rim > self.rim_speed {
            let share = self.rim_speed / rim;
            Twist {
                linear: share * linear,
                angular: share * angular,
            }
        } else {
            Twist { linear, angular }
        }
    }
}

/// Speed of the faster wheel's rim \[m/s\]: |v| + l |w|/2.
pub(crate) fn rim_speed<T: Scalar>(linear: T, angular: T, half_track_m: T) -> T {
    linear.abs() + half_track_m * angular.abs()
}
