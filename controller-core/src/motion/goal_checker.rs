//! Parked, or stuck: whether a robot has arrived.

use super::error_view::ErrorView;
use super::governor::Command;
use super::limits::rim_speed;
use super::params::ValidMotionParams;
use super::pose_law::Moving;
use crate::pose_error::PoseError;
use crate::scalar::Scalar;
use crate::types::Twist;

/// Decay of the transition offset that stops a parked robot \[1/s\], whatever that of the pose neurons is: nothing moves a second after
/// arrival.
pub(crate) const STOPPING_DECAY: f64 = 12.0;

/// What was inside for a moment may be this many tolerances off until the dwell has passed: with noise on it, an error near the
/// tolerance is inside now and outside then. It is the margin of the heading at rest as well.
const HYSTERESIS: f64 = 1.3;

/// Whether the robot is parked, and for how long it has been fit to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GoalChecker<T> {
    pub(crate) parked: bool,
    inside_s: T,
}

/// Where the robot is with respect to its goal, and how it moves.
pub(crate) struct GoalView<'a, T> {
    pub(crate) view: &'a ErrorView<T>,
    /// Square of the distance to the goal: what is compared with it is squared instead of a root taken.
    pub(crate) square: T,
    pub(crate) twist: &'a Twist<T>,
    pub(crate) command: &'a Command<T>,
    /// Rim speeds that are commanded and measured.
    pub(crate) asked: T,
    pub(crate) done: T,
    /// The robot backs up to the goal.
    pub(crate) backing: bool,
    /// How it stops there.
    pub(crate) ending: Ending,
}

/// How the command of a robot that has arrived comes to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// By a transition offset of [`STOPPING_DECAY`]: by feedback a robot arrives as fast as it likes.
    Fading,
    /// At once, as far as the limits allow. A manoeuvre ends at rest, and what its follower then commands is little; while it faded
    /// friction's compensation, which knows the command's sign alone, would break a wheel loose.
    AtOnce,
}

impl<T: Scalar> GoalChecker<T> {
    /// Not parked.
    pub(crate) const NEW: Self = Self {
        parked: false,
        inside_s: T::ZERO,
    };

    /// Inside the tolerance, for less than the dwell.
    pub(crate) fn is_settling(&self, motion: &ValidMotionParams<T>) -> bool {
        self.inside_s > T::ZERO && self.inside_s <= motion.params().arrival.dwell_s
    }

    /// A parked robot is so near its goal that it stays parked, as [`advance`](Self::advance) would find with more work: what is
    /// within half of the distance in both directions together is so without a root.
    pub(crate) fn stays(&self, motion: &ValidMotionParams<T>, error: &PoseError<T>) -> bool {
        self.parked
            && error.x.abs() + error.y.abs() <= T::HALF * motion.leave_distance()
            && error.theta.abs() < leave_heading(motion)
    }

    /// A tick of `dt` of a robot that [`stays`](Self::stays).
    pub(crate) fn stay(&mut self, dt: T) {
        self.inside_s += dt;
    }

    /// The latch after a tick of `dt`.
    ///
    /// Enters when the place where the stop would end was inside the tolerance, and for the dwell since then no
    /// further from the goal than [`HYSTERESIS`] tolerances: a transition offset
    /// from (v_c, a_c) travels (a_c + 2 A v_c)/A², and the velocity loop's lag adds its own. Leaves
    /// when the robot is pushed beyond [`ValidMotionParams::leave_distance`] or [`HYSTERESIS`] times the heading, but not in
    /// the first second, while it still settles.
    pub(crate) fn advance(
        &self,
        motion: &ValidMotionParams<T>,
        at: &GoalView<'_, T>,
        dt: T,
    ) -> Self {
        let f = T::from_f64;
        let limits = &motion.params().arrival;
        let close = at.is_within(motion.leave_distance());
        let fit = if self.parked {
            let turned = at.view.error.theta.abs() < leave_heading(motion);
            (close && turned) || self.inside_s < T::ONE
        } else {
            let PoseError {
                x: dx,
                y: dy,
                theta,
            } = at.error_at_rest(motion, dt);
            let enough = if self.inside_s > T::ZERO {
                f(HYSTERESIS) * limits.distance_m
            } else {
                limits.distance_m
            };
            let near = dx * dx + dy * dy < enough * enough;
            let turned = theta.abs() < limits.heading_rad;
            near && turned && close
        };
        if fit {
            let inside_s = self.inside_s + dt;
            Self {
                parked: self.parked || inside_s > limits.dwell_s,
                inside_s,
            }
        } else {
            Self::default()
        }
    }
}

impl<'a, T: Scalar> GoalView<'a, T> {
    /// Of a robot that backs up, or does not.
    #[inline(always)]
    pub(crate) fn of(
        motion: &ValidMotionParams<T>,
        view: &'a ErrorView<T>,
        moving: Moving<'a, T>,
        (backing, ending): (bool, Ending),
    ) -> Self {
        let PoseError { x, y, .. } = view.error;
        Self {
            view,
            square: x * x + y * y,
            twist: moving.twist,
            command: moving.command,
            asked: motion.rim_speed(&moving.command.twist),
            done: motion.rim_speed(moving.twist),
            backing,
            ending,
        }
    }

    /// Nearer to the goal than that.
    pub(crate) fn is_within(&self, distance: T) -> bool {
        self.square < distance * distance
    }

    /// Further from it.
    pub(crate) fn is_beyond(&self, distance: T) -> bool {
        self.square > distance * distance
    }

    /// The error where a stop that is begun now ends: a transition offset, if there is one,
    /// from (v_c, a_c) travels (a_c + 2 A v_c)/A², and the velocity loop's lag adds its own.
    pub(crate) fn error_at_rest(&self, motion: &ValidMotionParams<T>, dt: T) -> PoseError<T> {
        let gains = motion.gains();
        let Command {
            twist: command,
            rate,
        } = self.command;
        let error = &self.view.error;
        let lags = |speed, command, rate, bandwidth| (speed - command - dt * rate) / bandwidth;
        let mut v = lags(
            self.twist.linear,
            command.linear,
            rate.linear,
            gains.speed_loop,
        );
        let mut w = lags(
            self.twist.angular,
            command.angular,
            rate.angular,
            gains.turn_loop,
        );
        if self.ending == Ending::Fading {
            v += faded(command.linear, rate.linear);
            w += faded(command.angular, rate.angular);
        }
        PoseError {
            x: error.x - v,
            y: error.y,
            theta: error.theta - w,
        }
    }
}

/// Heading error at which a parked robot has left its goal \[rad\].
fn leave_heading<T: Scalar>(motion: &ValidMotionParams<T>) -> T {
    T::from_f64(HYSTERESIS) * motion.params().arrival.heading_rad
}

/// How far a command still carries that fades.
fn faded<T: Scalar>(command: T, rate: T) -> T {
    let decay = T::from_f64(STOPPING_DECAY);
    (rate + (decay + decay) * command) / (decay * decay)
}

impl<T: Scalar> ValidMotionParams<T> {
    /// Distance at which a parked robot has left its goal \[m\]: twice the tolerance, and five standard
    /// deviations, so that it is never noise that ends a rest.
    pub(crate) fn leave_distance(&self) -> T {
        let params = self.params();
        let tolerance = params.arrival.distance_m;
        tolerance + tolerance + T::from_f64(5.0) * params.pose_noise_m
    }

    /// Speed of the faster wheel \[m/s\].
    pub(crate) fn rim_speed(&self, twist: &Twist<T>) -> T {
        rim_speed(twist.linear, twist.angular, self.plan.half_track)
    }
}

/// How long a commanded motion has not happened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stall<T> {
    since_s: T,
}

/// What is asked of a robot and what it does.
pub(crate) struct Pushing<T> {
    pub(crate) command: Twist<T>,
    pub(crate) twist: Twist<T>,
    /// A wheel was at its limit. The command is then set back to nearly what is achieved.
    pub(crate) saturated: bool,
}

impl<T: Scalar> Stall<T> {
    /// Not stuck.
    pub(crate) const NEW: Self = Self { since_s: T::ZERO };

    pub(crate) fn advance(&self, motion: &ValidMotionParams<T>, now: &Pushing<T>, dt: T) -> Self {
        let tenth = T::from_f64(0.1);
        let (asked, done) = (motion.rim_speed(&now.command), motion.rim_speed(&now.twist));
        let least = motion.params().arrival.stall_speed;
        let stuck = if asked > least {
            done < tenth * asked
        } else {
            now.saturated && done < tenth * least
        };
        Self {
            since_s: if stuck { self.since_s + dt } else { T::ZERO },
        }
    }

    pub(crate) fn is_stalled(&self, motion: &ValidMotionParams<T>) -> bool {
        self.since_s > motion.params().arrival.stall_s
    }
}
