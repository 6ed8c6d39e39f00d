//! Driving by velocity: a speed and a turn rate as a host or an operator orders them.

use super::gains::DISTURBANCE;
use super::governor::Command;
use super::limits::Limits;
use super::params::ValidMotionParams;
use super::setpoint::Setpoint;
use super::transition_offset::AxisOffset;
use crate::angle::wrap;
use crate::error::{Input, StepFault};
use crate::maths::Maths;
use crate::range::{clamp, larger, smaller};
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::types::{Accel, Pose, Twist};

/// Largest speed \[m/s\] and turn rate \[rad/s\] of an order: as of [`Limits`](super::Limits), so that every base can be
/// ordered its limits, and what is beyond is a mistake in the unit or in the sender.
const LARGEST: f64 = 100.0;

/// Looks whether a velocity order is one: finite, and within ±100 m/s and ±100 rad/s. What is beyond the limits of a base and
/// within these is driven at the limits, and reported as [`Limited::speed`](super::Limited::speed).
///
/// # Errors
/// [`StepFault::NotFinite`] or [`StepFault::OutOfRange`] of [`Input::Order`].
pub fn check_order<T: Scalar>(twist: &Twist<T>) -> Result<(), StepFault> {
    let largest = T::from_f64(LARGEST);
    if !twist.is_finite() {
        Err(StepFault::NotFinite(Input::Order))
    } else if twist.linear.abs() > largest || twist.angular.abs() > largest {
        Err(StepFault::OutOfRange(Input::Order))
    } else {
        Ok(())
    }
}

/// Looks whether a goal is one, or a pose that somebody states: see [`Pose::check`]. A controller parks at any goal within 10 km of the
/// robot, and refuses one that is not as [`StepFault::Overflow`]; this is to be asked where goals come in.
///
/// # Errors
/// [`StepFault::NotFinite`] or [`StepFault::OutOfRange`] of [`Input::Goal`].
pub fn check_goal<T: Scalar>(goal: &Pose<T>) -> Result<(), StepFault> {
    goal.check(Input::Goal)
}

/// A robot that is ordered to stand does so below this speed and turn rate \[m/s, rad/s\].
const STILL: f64 = 0.01;

/// 1/T, the rate with which a heading that is not held is forgotten \[1/s\]: that of the disturbance estimate. What turns the base as it sets
/// off, until the estimate has learnt it, is turned back; to a push that lasts longer the base gives in.
const FORGETS: f64 = DISTURBANCE;

/// What driving by velocity remembers: the heading that it is to have. Everything else is in the command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DriveLaw<T> {
    /// The heading ordered so far, while the robot moves \[rad\].
    held: Option<T>,
    /// What the heading adds to the turn rate, and the rate of that.
    added: T,
    added_rate: T,
}

/// The present instant of a velocity order.
pub(crate) struct Now<'a, T> {
    pub(crate) order: &'a Twist<T>,
    pub(crate) hold_heading: bool,
    /// Measured.
    pub(crate) heading: T,
    /// Measured.
    pub(crate) turn_rate: T,
    /// Heading error, of [`DriveLaw::held`].
    pub(crate) error: T,
    /// Of the last tick.
    pub(crate) command: &'a Command<T>,
    pub(crate) jumped: bool,
    pub(crate) dt: T,
}

impl<T: Scalar> DriveLaw<T> {
    /// A robot at rest.
    pub(crate) const NEW: Self = Self {
        held: None,
        added: T::ZERO,
        added_rate: T::ZERO,
    };

    /// The heading goes on by what was commanded since the last tick, without what the heading itself added.
    pub(crate) fn turn_on(&mut self, command: &Command<T>, dt: T) {
        if let Some(held) = &mut self.held {
            let turned = command.twist.angular - self.added;
            let rate = command.rate.angular - self.added_rate;
            *held = wrap(*held + dt * (turned + T::HALF * dt * rate));
        }
    }

    /// The heading error of a robot that looks to `heading`; 0 at rest.
    pub(crate) fn error(&self, heading: T) -> T {
        self.held.map_or(T::ZERO, |held| wrap(held - heading))
    }

    /// The setpoint goes from the command to the order as two lags in cascade do,
    ///
    /// ```text
    /// v_d″ + 2 A v_d′ + A² (v_d − v) = 0        A = e min(j/a, j_w/α)
    /// w_d = w_s + k₃ sin e_θ                    w_s likewise towards w
    /// e_θ′ = w_s − w − e_θ/T                    T = 0.4 s, or ∞ where the heading is held
    /// ```
    ///
    /// with the exact solution over a tick, from where the governor left the command: what it limited is not asked for again, and
    /// orders may change in every tick. The lag brakes from the largest acceleration a with a jerk of
    /// A a/e at most, so that the jerk limit j makes no command overshoot its order; no slower lag is needed for that.
    ///
    /// The heading that is held is the integral of w_s; one that is not is remembered for T. Its error is bounded to a quarter of a
    /// turn, where the sine is largest. A robot that is ordered to stand holds it until it does, and none at rest: noise of the pose
    /// would turn it.
    pub(crate) fn advance<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        now: &Now<'_, T>,
    ) -> Setpoint<T> {
        if now.jumped {
            *self = Self::default();
        }
        let order = motion.reachable(now.order);
        let (twist, rate) = (&now.command.twist, &now.command.rate);
        let decay = decay(&motion.params().limits);
        let fade = T::ONE + M::exp_m1(-(decay * now.dt));
        // Value and rate at the end of the tick.
        let lagged = |value: T, rate: T, order: T| {
            let gap = AxisOffset {
                value: value - order,
                rate,
            };
            let gap = gap.advance(decay, now.dt, fade);
            (order + gap.value, gap.rate)
        };
        let (linear, linear_rate) = lagged(twist.linear, rate.linear, order.linear);
        let (angular, angular_rate) = lagged(
            twist.angular - self.added,
            rate.angular - self.added_rate,
            order.angular,
        );
        let still = T::from_f64(STILL);
        let moves = order != Twist::default() || linear.abs() > still || angular.abs() > still;
        let forgets = if now.hold_heading {
            T::ZERO
        } else {
            T::from_f64(FORGETS)
        };
        *self = if moves {
            let error = if self.held.is_some() {
                clamp(now.error, T::FRAC_PI_2) / (T::ONE + forgets * now.dt)
            } else {
                T::ZERO
            };
            let (sine, cosine) = M::sin_cos_near(error);
            let gain = motion.gains().heading;
            Self {
                held: Some(now.heading + error),
                added: gain * sine,
                added_rate: gain * cosine * (angular - now.turn_rate - forgets * error),
            }
        } else {
            Self::default()
        };
        Setpoint {
            twist: Twist {
                linear,
                angular: angular + self.added,
            },
            rate: Accel {
                linear: linear_rate,
                angular: angular_rate + self.added_rate,
            },
        }
    }

    pub(crate) fn residue(&self) -> T {
        let held = self.held.unwrap_or(T::ZERO);
        residue([held, self.added, self.added_rate])
    }
}

/// A \[1/s\]: the fastest at which neither axis needs more than its jerk limit to brake from its largest acceleration. One for both, so
/// that a change of the twist keeps its curvature where no limit of acceleration is in its way.
fn decay<T: Scalar>(limits: &Limits<T>) -> T {
    let accel = larger(limits.accel, limits.brake);
    let (linear, angular) = (limits.jerk / accel, limits.turn_jerk / limits.turn_accel);
    T::from_f64(core::f64::consts::E) * smaller(linear, angular)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::Libm;
    use crate::motion::MotionParams;
    use crate::robot::Robot;

    fn motion() -> ValidMotionParams<f64> {
        let params = MotionParams::new(Robot::paper(), Limits::PAPER);
        params.validate().expect("valid")
    }

    /// Whatever is not a number shows: a tick with it is refused.
    #[test]
    fn no_number_is_overlooked() {
        assert_eq!(DriveLaw::<f64>::NEW.residue(), 0.0);
        for wrong in [f64::NAN, f64::INFINITY] {
            for law in [
                DriveLaw {
                    held: Some(wrong),
                    ..DriveLaw::NEW
                },
                DriveLaw {
                    added: wrong,
                    ..DriveLaw::NEW
                },
                DriveLaw {
                    added_rate: wrong,
                    ..DriveLaw::NEW
                },
            ] {
                assert!(law.residue().is_nan(), "{law:?}");
            }
        }
    }

    /// The heading that is held goes on by what was commanded, along a ramp of the turn rate too, and without what it added itself.
    #[test]
    fn a_held_heading_goes_on_along_a_ramp() {
        let mut law = DriveLaw {
            held: Some(0.3),
            added: 0.05,
            added_rate: -0.2,
        };
        let command = Command {
            twist: Twist::new(0.3, 0.6),
            rate: Accel::new(0.0, 3.0),
        };
        law.turn_on(&command, 0.1);
        // 0.55 rad/s for 0.1 s, and 3.2 rad/s² of it.
        let held = 0.3 + 0.1 * 0.55 + 0.5 * 0.01 * 3.2;
        assert!((law.error(0.0) - held).abs() < 1e-15, "{law:?}");
    }

    /// What a held heading adds to the turn rate, and its rate, is that of k sin e while e goes as the robot turns less than it should.
    #[test]
    fn the_rate_of_what_a_heading_adds_is_its_derivative() {
        let motion = motion();
        let order = Twist::new(0.3, 0.4);
        let law = |error: f64| {
            let mut law = DriveLaw {
                held: Some(0.0),
                ..DriveLaw::NEW
            };
            let command = Command {
                twist: order,
                ..Command::default()
            };
            let now = Now {
                order: &order,
                hold_heading: true,
                heading: -error,
                turn_rate: -0.2,
                error,
                command: &command,
                jumped: false,
                dt: 0.01,
            };
            let setpoint = law.advance::<Libm>(&motion, &now);
            (setpoint.twist.angular, setpoint.rate.angular)
        };
        let step = 1e-4;
        for error in [-1.2, -0.3, 0.0, 0.6, 1.2] {
            let (before, after) = (law(error - 0.6 * step).0, law(error + 0.6 * step).0);
            assert!((before - (0.4 + motion.gains().heading * error.sin())).abs() < 1e-3);
            // Of the difference k/6 (0.6 step)³/step is left, and roundings of 1e-16/step.
            let rate = (after - before) / (2.0 * step);
            assert!((law(error).1 - rate).abs() < 1e-7, "{error}: {rate}");
        }
    }
}
