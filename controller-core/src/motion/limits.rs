//! What the base can do.

use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::range::within;
use crate::scalar::Scalar;

/// Share of the wheels' torque that the command may use; the rest is the velocity loop's.
pub(crate) const COMMAND_SHARE: f64 = 0.75;

/// Limits of a base, each positive and finite. The controller stays inside all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits<T = f32> {
    /// Largest speed, forward or backward \[m/s\], 1e-3 to 100.
    pub speed: T,
    /// Largest turn rate \[rad/s\], 1e-3 to 100.
    pub turn_rate: T,
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

impl<T: Scalar> Limits<T> {
    pub(crate) fn check(&self) -> Result<(), ParamError> {
        for (field, value, low, high) in [
            (Field::MaxSpeed, self.speed, 1.0e-3, 100.0),
            (Field::MaxTurnRate, self.turn_rate, 1.0e-3, 100.0),
            (Field::MaxAccel, self.accel, 1.0e-3, 1.0e3),
            (Field::MaxBrake, self.brake, 1.0e-3, 1.0e3),
            (Field::MaxTurnAccel, self.turn_accel, 1.0e-3, 1.0e4),
            (Field::MaxJerk, self.jerk, 1.0e-2, 1.0e6),
            (Field::MaxTurnJerk, self.turn_jerk, 1.0e-2, 1.0e6),
            (Field::MaxWheelTorque, self.wheel_torque_nm, 1.0e-6, 1.0e6),
        ] {
            within(field, value, low, high)?;
        }
        Ok(())
    }
}
