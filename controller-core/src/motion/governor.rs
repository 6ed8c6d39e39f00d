//! Keeps the command within what the base can do, and says so.

use super::limits::Limits;
use super::params::ValidMotionParams;
use super::report::Limited;
use super::saturation::share;
use super::setpoint::Setpoint;
use crate::range::{clamp, larger};
use crate::scalar::Scalar;
use crate::types::{Accel, Twist, Wrench};

/// The command: what the velocity loop is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Command<T> {
    pub(crate) twist: Twist<T>,
    pub(crate) rate: Accel<T>,
}

impl<T: Scalar> Command<T> {
    /// Stand.
    pub(crate) const REST: Self = Self {
        twist: Twist::new(T::ZERO, T::ZERO),
        rate: Accel::new(T::ZERO, T::ZERO),
    };

    /// The command that asks a robot for what it does already, as far as the limits allow.
    pub(crate) fn of_robot(motion: &ValidMotionParams<T>, twist: &Twist<T>) -> Self {
        Self {
            twist: motion.reachable(twist),
            rate: Accel::default(),
        }
    }

    /// The same for a robot that accelerates.
    pub(crate) fn of_moving(
        motion: &ValidMotionParams<T>,
        twist: &Twist<T>,
        accel: &Accel<T>,
    ) -> Self {
        let robot = Self::of_robot(motion, twist);
        let rate = robot.within_accel(motion, accel).unwrap_or(*accel);
        Self { rate, ..robot }
    }

    /// The command one tick on: a copy of the setpoint, slewed. With no limit at work it is the setpoint,
    /// value and rate, without lag.
    ///
    /// The speed moves towards the desired one by at most accel (or brake) · dt; what is fed forward
    /// is the desired rate, or the slewed one, moved by at most jerk · dt. The latter is never
    /// integrated into the former: noise in it would become an error of the command.
    pub(crate) fn advance(
        &self,
        motion: &ValidMotionParams<T>,
        setpoint: &Setpoint<T>,
        dt: T,
    ) -> (Self, Limited) {
        let limits = &motion.params().limits;
        let mut limited = Limited::default();
        let mut setpoint = *setpoint;
        let rim = motion.rim_speed(&setpoint.twist);
        if rim > limits.rim_speed {
            setpoint = self.below_rim(motion, &setpoint, limits.rim_speed / rim);
            limited.speed = true;
        }
        let mut slew = Accel {
            linear: (setpoint.twist.linear - self.twist.linear) / dt,
            angular: (setpoint.twist.angular - self.twist.angular) / dt,
        };
        let mut rate = setpoint.rate;
        if let Some(less) = self.slew(motion, &slew) {
            if less.linear != slew.linear {
                rate.linear = less.linear;
                limited.accel = true;
            }
            if less.angular != slew.angular {
                rate.angular = less.angular;
                limited.accel = true;
            }
            slew = less;
        }
        let moved = Twist {
            linear: self.twist.linear + slew.linear * dt,
            angular: self.twist.angular + slew.angular * dt,
        };
        let mut twist = moved;
        let slow = moved.linear.abs() <= limits.speed && moved.angular.abs() <= limits.turn_rate;
        if !slow {
            twist = Twist {
                linear: clamp(moved.linear, limits.speed),
                angular: clamp(moved.angular, limits.turn_rate),
            };
            limited.speed = true;
        }
        let excess = motion.rim_speed(&twist) - limits.rim_speed;
        if excess > T::ZERO {
            let less = self.within_rim(motion, &twist, excess);
            // What is taken off the step is taken off its rate: a step too long by a rounding changes nothing else.
            rate.linear += (less.linear - twist.linear) / dt;
            rate.angular += (less.angular - twist.angular) / dt;
            twist = less;
            limited.speed = true;
        }
        rate.linear = not_outward(rate.linear, setpoint.twist.linear, limits.speed);
        rate.angular = not_outward(rate.angular, setpoint.twist.angular, limits.turn_rate);
        let rate = self.within_accel(motion, &rate).unwrap_or(rate);
        let (linear, linear_jerk) = towards(self.rate.linear, rate.linear, limits.jerk * dt);
        let (angular, angular_jerk) =
            towards(self.rate.angular, rate.angular, limits.turn_jerk * dt);
        limited.jerk = linear_jerk || angular_jerk;
        let rate = Accel { linear, angular };
        (Self { twist, rate }, limited)
    }

    /// The setpoint with a rim as fast as it may be, for one that asks more, of which that is this `share`: its curvature is kept,
    /// and no rate points outward.
    #[cold]
    #[inline(never)]
    fn below_rim(
        &self,
        motion: &ValidMotionParams<T>,
        setpoint: &Setpoint<T>,
        share: T,
    ) -> Setpoint<T> {
        let Setpoint { twist, rate } = setpoint;
        let rate = &self.within_accel(motion, rate).unwrap_or(*rate);
        Setpoint {
            twist: motion.reachable(twist),
            rate: Accel {
                linear: share * inward(rate.linear, twist.linear),
                angular: share * inward(rate.angular, twist.angular),
            },
        }
    }

    /// `to` without what makes a rim faster than it may be by `excess` \[m/s\].
    ///
    /// The command was within that limit: what |v| and l |w|/2 have grown by is more than the excess, and both give up the same
    /// share of it. So each stays between what it was and what it was to be, within its acceleration.
    #[cold]
    #[inline(never)]
    fn within_rim(&self, motion: &ValidMotionParams<T>, to: &Twist<T>, excess: T) -> Twist<T> {
        let grown = |from: T, to: T| larger(to.abs() - from.abs(), T::ZERO);
        let linear = grown(self.twist.linear, to.linear);
        let angular = grown(self.twist.angular, to.angular);
        let growth = motion.rim_speed(&Twist::new(linear, angular));
        // Rounding aside the excess is the smaller one.
        let share = if excess < growth {
            excess / growth
        } else {
            T::ONE
        };
        let less = |value: T, by: T| {
            if value < T::ZERO {
                value + by
            } else {
                value - by
            }
        };
        Twist {
            linear: less(to.linear, share * linear),
            angular: less(to.angular, share * angular),
        }
    }

    /// `needed` within acceleration, braking and the wheels' share for the command; `None` as of [`within_accel`](Self::within_accel).
    fn slew(&self, motion: &ValidMotionParams<T>, needed: &Accel<T>) -> Option<Accel<T>> {
        let params = motion.params();
        let limits = &params.limits;
        let less = self.within_accel(motion, needed);
        let desired = less.unwrap_or(*needed);
        let wrench = Wrench {
            force: params.robot.mass_kg * desired.linear,
            moment: params.robot.inertia_kg_m2 * desired.angular,
        };
        let torque = motion.command_torque_nm;
        let (shared, limited) = share(&motion.wheels, &wrench, torque, limits.policy);
        if !limited {
            return less;
        }
        // An axis that did not yield keeps its bits: m (x/m) may be another number than x, and would count as slewed.
        Some(Accel {
            linear: if shared.force != wrench.force {
                shared.force / params.robot.mass_kg
            } else {
                desired.linear
            },
            angular: if shared.moment != wrench.moment {
                shared.moment / params.robot.inertia_kg_m2
            } else {
                desired.angular
            },
        })
    }

    /// `rate` within the limits; `None` where it is by both limits of driving. Braking is towards rest, accelerating away from it.
    fn within_accel(&self, motion: &ValidMotionParams<T>, rate: &Accel<T>) -> Option<Accel<T>> {
        let limits = &motion.params().limits;
        let gentle = rate.linear.abs() <= motion.gentle;
        let turns = rate.angular.abs() <= limits.turn_accel;
        if gentle && turns {
            return None;
        }
        Some(Accel {
            linear: if gentle {
                rate.linear
            } else {
                self.within_its_side(limits, rate.linear)
            },
            angular: clamp(rate.angular, limits.turn_accel),
        })
    }

    /// A rate beyond the smaller of the two limits.
    #[cold]
    #[inline(never)]
    fn within_its_side(&self, limits: &Limits<T>, rate: T) -> T {
        let v = self.twist.linear;
        let (up, down) = if v > T::ZERO {
            (limits.accel, limits.brake)
        } else if v < T::ZERO {
            (limits.brake, limits.accel)
        } else {
            (limits.accel, limits.accel)
        };
        if rate > up {
            up
        } else if rate < -down {
            -down
        } else {
            rate
        }
    }
}

/// 0 instead of a rate that points beyond the limit at which the setpoint stands.
#[inline(always)]
fn not_outward<T: Scalar>(rate: T, setpoint: T, limit: T) -> T {
    if setpoint.abs() >= limit {
        inward(rate, setpoint)
    } else {
        rate
    }
}

/// 0 instead of a rate that makes the setpoint larger.
#[cold]
#[inline(never)]
fn inward<T: Scalar>(rate: T, setpoint: T) -> T {
    if rate * setpoint > T::ZERO {
        T::ZERO
    } else {
        rate
    }
}

/// `to`, but at most `step` away from `from`, and whether that mattered.
fn towards<T: Scalar>(from: T, to: T, step: T) -> (T, bool) {
    if to > from + step {
        (from + step, true)
    } else if to < from - step {
        (from - step, true)
    } else {
        (to, false)
    }
}

#[cfg(test)]
mod tests;
