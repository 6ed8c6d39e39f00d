//! A robot that stands beside its goal: manoeuvres as long as they help, a bounded number of new approaches, then
//! the truth.

use super::arrival::Arrival;
use super::goal_checker::GoalView;
use super::params::ValidMotionParams;
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::{larger, signed};
use crate::scalar::Scalar;

/// Rests that may end without a push before the next such end counts as an attempt. The stop is
/// predicted, and errs once in some 80 runs, by a few tenths of a milliradian; a heading that is
/// noisier than its tolerance ends every rest.
const LOSSES: u8 = 3;

/// How much faster patience ends for a robot that is beside its goal and level with it: all that patience
/// can bring is the heading, and a better pose. A quarter of it is two time constants of the approach and a dwell.
const BESIDE: f64 = 4.0;

/// Manoeuvres beyond the first before an attempt is spent. Each leaves what the pose and the knowledge of friction and mass
/// leave, a few per cent of its way: from 3 m two bring a robot to a millimetre.
const MANOEUVRES: u8 = 2;

/// The way of a new approach at least \[m\], on which friction is overcome and learnt, and how far the robot turns on it aside for what is left beside the
/// goal \[rad\], which is corrected without haste.
pub(crate) const NEW_APPROACH: (f64, f64) = (0.05, 0.1);

/// Where a robot is in its attempts to arrive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Retry<T> {
    /// New approaches so far.
    pub(crate) count: u8,
    /// No more: the robot stands outside of its tolerance until it gets a new task.
    pub(crate) given_up: bool,
    /// Rests that ended by themselves since the last attempt.
    losses: u8,
    /// Driving out: 1 to behind the goal, −1 to in front of it; 0 towards the goal.
    out: T,
    /// How long the robot has been fit to be called stuck, or has been driving out.
    since_s: T,
    /// How long it has been parked \[s\].
    parked_s: T,
    /// The last approach from afar: 1 forward, −1 backward.
    came: T,
    /// Manoeuvres since the last attempt, beyond the first.
    manoeuvres: u8,
}

/// What is to be done about a robot that is not parked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Attempt {
    /// Nothing new.
    GoOn,
    /// To hold where the goal is, which the robot has just left by a little.
    Hold,
    /// Another manoeuvre.
    Manoeuvre,
    /// Another aim, approached by feedback: the place to drive out to, or the goal again.
    Aim,
}

/// What the latch made of the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rest {
    /// Not parked, after a manoeuvre.
    Beside,
    /// Not parked, approaching by feedback.
    Moving,
    /// Inside the tolerance, for less than the dwell.
    Settling,
    /// Parked.
    Parked,
    /// Parked until now.
    Lost,
}

impl<T: Scalar> Retry<T> {
    /// All approaches are to be had.
    pub(crate) const NEW: Self = Self {
        count: 0,
        given_up: false,
        losses: 0,
        out: T::ZERO,
        since_s: T::ZERO,
        parked_s: T::ZERO,
        came: T::ZERO,
        manoeuvres: 0,
    };

    /// Neither driving out, where the goal is left on purpose, nor given up.
    pub(crate) fn may_park(&self) -> bool {
        !(self.is_out() || self.given_up)
    }

    /// Full accelerations have led beside this goal twice.
    pub(crate) fn has_failed_twice(&self) -> bool {
        self.manoeuvres > 1 || self.count > 0
    }

    /// Driving out.
    pub(crate) fn is_out(&self) -> bool {
        self.out != T::ZERO
    }

    /// Parked for another `dt`.
    pub(crate) fn rests(&mut self, dt: T) {
        self.since_s = T::ZERO;
        self.parked_s += dt;
    }

    /// Not parked, with a manoeuvre under way.
    pub(crate) fn drives(&mut self) {
        self.since_s = T::ZERO;
    }

    /// A tick of `dt`; what is to be done.
    ///
    /// After a manoeuvre that ended beside the goal up to [`MANOEUVRES`] more are had for nothing, and an approach by feedback. Then an attempt
    /// is spent: the robot drives out and comes back by feedback, which learns friction on the way.
    ///
    /// A robot is stuck that for [`ValidMotionParams::patience`] is near the goal, or hardly moves, and is not parked, or for
    /// six times as long is closer than a retry drives out; beside the goal a quarter of the time is enough. A
    /// stall (a speed is asked for and not reached) is reported as one, and is no reason to try again.
    pub(crate) fn advance<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        at: &GoalView<'_, T>,
        rest: Rest,
        dt: T,
    ) -> Attempt {
        if self.given_up {
            return Attempt::GoOn;
        }
        let error = &at.view.error;
        let way_out = motion.way_out();
        if self.is_out() {
            self.since_s += dt;
            // A quarter of the way short: nobody needs the exact place.
            let left = distance_of::<T, M>(&self.aim::<M>(motion, error));
            if left < T::from_f64(0.25) * way_out || self.since_s > motion.patience() {
                self.out = T::ZERO;
                self.since_s = T::ZERO;
            }
            return if self.is_out() {
                Attempt::GoOn
            } else {
                Attempt::Aim
            };
        }
        let arrival = &motion.params().arrival;
        match rest {
            Rest::Parked => {
                self.rests(dt);
                return Attempt::GoOn;
            }
            Rest::Lost => {
                // A push by hand does more, and comes when it likes.
                let four = T::from_f64(4.0);
                let slightly = !at.is_beyond(motion.leave_distance())
                    && error.theta.abs() <= four * arrival.heading_rad;
                let soon = self.parked_s < motion.patience();
                self.parked_s = T::ZERO;
                let pushed = !(slightly || soon && is_near(motion, at));
                if pushed {
                    self.count = 0;
                    self.losses = 0;
                    self.manoeuvres = 0;
                } else if self.losses < LOSSES {
                    self.losses = self.losses.saturating_add(1);
                } else {
                    self.losses = 0;
                    self.spend(motion);
                }
                self.since_s = T::ZERO;
                return if slightly {
                    Attempt::Hold
                } else {
                    Attempt::Manoeuvre
                };
            }
            // What was waited for until now counts on if this does not last.
            Rest::Settling => return Attempt::GoOn,
            Rest::Beside | Rest::Moving => {}
        }
        let came = self.came;
        if at.is_beyond(way_out) {
            self.came = if at.backing { -T::ONE } else { T::ONE };
        }
        if rest == Rest::Beside && (is_aside(motion, at) || is_held(motion, at)) {
            self.since_s += motion.patience() / motion.aside_patience(at) * dt;
        } else if is_stuck(motion, at) {
            let weight = if rest == Rest::Beside {
                motion.patience() / motion.hold_patience()
            } else if is_beside(motion, at) {
                T::from_f64(BESIDE)
            } else {
                T::ONE
            };
            self.since_s += weight * dt;
        } else if at.is_within(way_out) {
            // Moving, and still not there after six times the patience: stick and slip about the goal.
            self.since_s += dt * T::from_f64(1.0 / 6.0);
        } else if self.since_s > dt {
            // Noise may say otherwise now and then.
            self.since_s -= dt;
        } else {
            self.since_s = T::ZERO;
        }
        if self.since_s <= motion.patience() {
            return Attempt::GoOn;
        }
        self.since_s = T::ZERO;
        if rest == Rest::Beside && self.manoeuvres < MANOEUVRES {
            self.manoeuvres = self.manoeuvres.saturating_add(1);
            return Attempt::Manoeuvre;
        }
        // The first approach by feedback is no new one. It begins outside as well, where friction holds the robot, which would
        // hold it again near the goal and is learnt on the way, and where the robot would have to turn aside for millimetres.
        let first = rest == Rest::Beside && self.manoeuvres <= MANOEUVRES;
        if first {
            self.manoeuvres = MANOEUVRES + 1;
        }
        if (first && at.is_within(way_out) && (is_held(motion, at) || is_aside(motion, at)))
            || (!first && self.spend(motion))
        {
            self.out = signed(T::ONE, came);
        }
        Attempt::Aim
    }

    /// Takes one attempt, if there is one left; gives up if not.
    fn spend(&mut self, motion: &ValidMotionParams<T>) -> bool {
        if self.count < motion.params().arrival.retries {
            self.count = self.count.saturating_add(1);
            true
        } else {
            self.given_up = true;
            false
        }
    }

    /// The pose error that counts: to the goal, or to the place to drive out to, which is moved by
    /// ∓[`ValidMotionParams::way_out`] along the goal's heading.
    pub(crate) fn aim<M: Maths<T>>(
        &self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
    ) -> PoseError<T> {
        let moved = self.out * motion.way_out();
        let (sine, cosine) = M::sin_cos_near(error.theta);
        PoseError {
            x: error.x - moved * cosine,
            y: error.y - moved * sine,
            theta: error.theta,
        }
    }
}

/// \[m\].
pub(crate) fn distance_of<T: Scalar, M: Maths<T>>(error: &PoseError<T>) -> T {
    M::sqrt(error.x * error.x + error.y * error.y)
}

/// Level with the goal, but too far to the side: wheels cannot go there.
fn is_beside<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<'_, T>) -> bool {
    let tolerance = motion.params().arrival.distance_m;
    at.is_beyond(tolerance) && at.view.error.x.abs() < T::HALF * tolerance
}

/// Slow, and too far to the side: wheels cannot go there, and waiting changes nothing but the pose. Twice too far need not be slow.
fn is_aside<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<'_, T>) -> bool {
    let arrival = &motion.params().arrival;
    let (aside, tolerance) = (at.view.error.y.abs(), arrival.distance_m);
    let slow = at.asked <= arrival.stall_speed;
    aside > tolerance && (slow || aside > tolerance + tolerance)
}

/// Within ten tolerances of its goal.
fn is_near<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<'_, T>) -> bool {
    let ten = T::from_f64(10.0);
    let heading = motion.params().arrival.heading_rad;
    at.is_within(ten * motion.least()) && at.view.error.theta.abs() < ten * heading
}

/// Outside of the tolerance, and friction holds it there: what the integral of the following law needs seconds for, a
/// manoeuvre's feed-forward does at once.
fn is_held<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<'_, T>) -> bool {
    let arrival = &motion.params().arrival;
    let outside =
        at.is_beyond(arrival.distance_m) || at.view.error.theta.abs() > arrival.heading_rad;
    outside && at.asked <= arrival.stall_speed && at.done <= T::from_f64(0.1) * at.asked
}

fn is_stuck<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<'_, T>) -> bool {
    let arrival = &motion.params().arrival;
    // Slower than the approach is over four times the distance that counts as nothing.
    let four = T::from_f64(4.0);
    let creeps = at.done < four * motion.gains().approach * motion.least();
    is_near(motion, at) || (creeps && at.asked <= arrival.stall_speed)
}

impl<T: Scalar> ValidMotionParams<T> {
    /// The distance within which position means nothing: the tolerance or the noise radius \[m\].
    fn least(&self) -> T {
        larger(self.params().arrival.distance_m, self.near)
    }

    /// How far a retry drives out \[m\]: from there an error of twice the noise radius, the most that
    /// is left beside the goal, is a bearing of 0.1 rad; at least the way of a [`NEW_APPROACH`].
    fn way_out(&self) -> T {
        let (least, bearing) = NEW_APPROACH;
        larger(
            T::from_f64(2.0 / bearing) * self.least(),
            T::from_f64(least),
        )
    }

    /// How long a robot may stand near its goal before it tries again \[s\]: eight time constants of
    /// the approach, and four dwells. From ten times the tolerance it needs 2.3, its heading, through h β, 5.8. A
    /// filtered pose, whose dwell is about the filter's time constant, has to settle as well: without that time a 1 kg
    /// base left its goal when it was nearly there.
    fn patience(&self) -> T {
        let f = T::from_f64;
        f(8.0) / self.gains().approach + f(4.0) * self.params().arrival.dwell_s
    }

    /// How long a robot may stand near its goal after a manoeuvre before it tries again \[s\]: eight time constants of the
    /// following law, which holds it there, and four dwells.
    fn hold_patience(&self) -> T {
        let f = T::from_f64;
        let gains = self.gains();
        let slower = if gains.longitudinal < gains.heading {
            gains.longitudinal
        } else {
            gains.heading
        };
        f(8.0) / slower + f(4.0) * self.params().arrival.dwell_s
    }

    /// How long a robot may stand aside of its goal before another manoeuvre \[s\]: until its velocity has settled, and a
    /// filtered pose, whose time constant the dwell is, has lost a fifth of what it drifted by while the robot moved: a quarter of the
    /// dwell. What the pose may still move by, a tolerance at most, adds to what the next
    /// manoeuvre misses by as squares do: a goal that is further away is not worth as long a wait.
    fn aside_patience(&self, at: &GoalView<'_, T>) -> T {
        let gains = self.gains();
        let slower = if gains.speed_loop < gains.turn_loop {
            gains.speed_loop
        } else {
            gains.turn_loop
        };
        let Arrival {
            dwell_s,
            distance_m: tolerance,
            ..
        } = self.params().arrival;
        let share = if at.is_beyond(tolerance) {
            tolerance * tolerance / at.square
        } else {
            T::ONE
        };
        T::ONE / slower + T::from_f64(0.25) * share * dwell_s
    }
}
