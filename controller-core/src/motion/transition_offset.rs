//! What the command still owes to the past: a jump of the setpoint, fading.

use super::governor::Command;
use super::setpoint::Setpoint;
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::types::{Accel, Twist};

/// Two neurons without input in cascade: b″ + 2 A b′ + A² b = 0.
///
/// Set at a jump so that the setpoint's value and rate go on from those of the command; from then on
/// both fade together. `rate` is the exact rate of `value`: command and feed-forward agree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AxisOffset<T> {
    pub(crate) value: T,
    pub(crate) rate: T,
}

impl<T: Scalar> AxisOffset<T> {
    const NONE: Self = Self {
        value: T::ZERO,
        rate: T::ZERO,
    };

    /// The exact solution after `dt`, with `fade` = exp(−A dt): b ← (b + q dt) fade with
    /// q = b′ + A b, and b′ ← (q − A (b + q dt)) fade.
    pub(crate) fn advance(&self, decay: T, dt: T, fade: T) -> Self {
        let q = self.rate + decay * self.value;
        let moved = self.value + q * dt;
        Self {
            value: moved * fade,
            rate: (q - decay * moved) * fade,
        }
    }
}

/// Transition offsets of speed and turn rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TransitionOffset<T> {
    linear: AxisOffset<T>,
    angular: AxisOffset<T>,
}

impl<T: Scalar> TransitionOffset<T> {
    /// Nothing is owed.
    pub(crate) const NONE: Self = Self {
        linear: AxisOffset::NONE,
        angular: AxisOffset::NONE,
    };

    /// Offsets with which the setpoint, from now on, goes on from where a command would be after `dt`, in
    /// value and, as far as it is `kept` (0 to 1), in rate.
    pub(crate) fn between(command: &Command<T>, setpoint: &Setpoint<T>, kept: T, dt: T) -> Self {
        let offset = |speed: T, accel: T, to: T, to_rate: T| {
            let rate = kept * (accel - to_rate);
            AxisOffset {
                value: speed + dt * (to_rate + rate) - to,
                rate,
            }
        };
        let (twist, rate) = (&command.twist, &command.rate);
        let (to, to_rate) = (&setpoint.twist, &setpoint.rate);
        Self {
            linear: offset(twist.linear, rate.linear, to.linear, to_rate.linear),
            angular: offset(twist.angular, rate.angular, to.angular, to_rate.angular),
        }
    }

    /// After `dt`, with decay A \[1/s\] and `fade` = exp(−A dt).
    pub(crate) fn advance(&self, decay: T, dt: T, fade: T) -> Self {
        Self {
            linear: self.linear.advance(decay, dt, fade),
            angular: self.angular.advance(decay, dt, fade),
        }
    }

    /// The setpoint with the offsets on top.
    pub(crate) fn added_to(&self, setpoint: &Setpoint<T>) -> Setpoint<T> {
        Setpoint {
            twist: Twist {
                linear: setpoint.twist.linear + self.linear.value,
                angular: setpoint.twist.angular + self.angular.value,
            },
            rate: Accel {
                linear: setpoint.rate.linear + self.linear.rate,
                angular: setpoint.rate.angular + self.angular.rate,
            },
        }
    }

    /// What they add to the setpoint's twist.
    pub(crate) fn twist(&self) -> Twist<T> {
        Twist {
            linear: self.linear.value,
            angular: self.angular.value,
        }
    }

    pub(crate) fn residue(&self) -> T {
        let (linear, angular) = (&self.linear, &self.angular);
        residue([linear.value, linear.rate, angular.value, angular.rate])
    }
}
