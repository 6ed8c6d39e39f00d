//! Commands to the motors.

use super::error::ActuationError;

/// Which wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The right one.
    Right,
    /// The left one.
    Left,
}

impl Side {
    /// Right, left.
    pub const BOTH: [Self; 2] = [Self::Right, Self::Left];

    /// 0 for right, 1 for left: the order of all pairs here.
    pub(super) fn index(self) -> usize {
        self as usize
    }
}

/// What the drivers do for a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Actuation {
    /// Share of the supply voltage at each motor, −1 to 1. Needs motors.
    Duty {
        /// Right wheel.
        right: f64,
        /// Left wheel.
        left: f64,
    },
    /// Torque at each wheel before friction and gear losses \[N m\]: an ideal current source, as
    /// far as current limit and supply allow.
    Torque {
        /// Right wheel.
        right: f64,
        /// Left wheel.
        left: f64,
    },
    /// Speed of each wheel \[rad/s\], held by the driver's own loop: without load the speed
    /// follows as a first-order lag (of turns on the spot or straight lines, whichever moves more of the body; of the others sooner), and a load is integrated away.
    Speed {
        /// Right wheel.
        right: f64,
        /// Left wheel.
        left: f64,
    },
    /// Shorted windings. Without motors there is nothing to short: as [`Actuation::Release`].
    Brake,
    /// Open windings.
    Release,
}

impl Actuation {
    pub(super) fn check(&self, has_motor: bool) -> Result<(), ActuationError> {
        let (Self::Duty { right, left }
        | Self::Torque { right, left }
        | Self::Speed { right, left }) = *self
        else {
            return Ok(());
        };
        if !(right.is_finite() && left.is_finite()) {
            return Err(ActuationError::NotFinite);
        }
        if matches!(self, Self::Duty { .. }) {
            if !has_motor {
                return Err(ActuationError::NoMotor);
            }
            if right.abs() > 1.0 || left.abs() > 1.0 {
                return Err(ActuationError::DutyAboveOne);
            }
        }
        Ok(())
    }
}
