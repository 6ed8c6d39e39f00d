//! The pose law of a tick: following, parking, a new approach, or rest at the goal.

use super::error_view::ErrorView;
use super::follow::{Follower, Instant};
use super::goal_checker::{GoalChecker, GoalView};
use super::governor::Command;
use super::params::ValidMotionParams;
use super::polar::PoseRegulator;
use super::retry::{Rest, Retry, distance_of};
use super::setpoint::Setpoint;
use super::task::Task;
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::Twist;

/// What the pose laws remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PoseLaw<T> {
    follower: Follower<T>,
    regulator: PoseRegulator<T>,
    checker: GoalChecker<T>,
    retry: Retry<T>,
}

/// How the robot moves, measured and commanded.
#[derive(Clone, Copy)]
pub(crate) struct Moving<'a, T> {
    /// Measured.
    pub(crate) twist: &'a Twist<T>,
    /// Of the last tick.
    pub(crate) command: &'a Command<T>,
}

/// Time since the last tick.
#[derive(Clone, Copy)]
pub(crate) struct Step<T> {
    /// \[s\].
    pub(crate) dt: T,
    /// 2/dt \[1/s\]; `None` where the laws start afresh from the command: at the start, and after a jump.
    pub(crate) two_per_dt: Option<T>,
}

/// What a pose law made of a tick.
pub(crate) struct Wanted<T> {
    pub(crate) setpoint: Setpoint<T>,
    /// Parked and not, or a new aim: the setpoint starts a new transition offset.
    pub(crate) rebase: bool,
}

impl<T: Scalar> PoseLaw<T> {
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        task: &Task<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        step: Step<T>,
    ) -> Wanted<T> {
        match task {
            Task::Follow(reference) => {
                self.follow::<U, M>(motion, reference, view, moving, step.two_per_dt)
            }
            Task::Park(_) => self.park::<U, M>(motion, &view.error, moving, step),
        }
    }

    fn follow<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        reference: &Reference<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        two_per_dt: Option<T>,
    ) -> Wanted<T> {
        let now = Instant {
            reference,
            error: view.error,
            heading: view.heading,
            turn_rate: moving.twist.angular,
        };
        self.checker = GoalChecker::default();
        let command = &moving.command.twist;
        Wanted {
            setpoint: self
                .follower
                .advance::<U, M>(motion, &now, command, two_per_dt),
            rebase: false,
        }
    }

    fn park<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
        moving: Moving<'_, T>,
        step: Step<T>,
    ) -> Wanted<T> {
        let Step { dt, two_per_dt } = step;
        let distance = distance_of::<T, M>(error);
        let (was_parked, was_resting) = (self.checker.parked, self.is_resting());
        let at = GoalView {
            error: *error,
            distance,
            twist: *moving.twist,
            command: moving.command.twist,
            command_rate: moving.command.rate,
            backing: self.regulator.is_backing(),
        };
        self.checker = match (two_per_dt, self.retry.may_park()) {
            (Some(_), true) => self.checker.advance(motion, &at, dt),
            (None, true) => GoalChecker::default().advance(motion, &at, dt),
            (_, false) => GoalChecker::default(),
        };
        let rest = match (was_parked && two_per_dt.is_some(), self.checker.parked) {
            (_, true) => Rest::Parked,
            (true, false) => Rest::Lost,
            (false, false) => Rest::Moving,
        };
        let (retry, new_aim) = self.retry.advance::<M>(motion, &at, rest, dt);
        self.retry = retry;
        let resting = self.is_resting();
        let setpoint = if resting {
            self.regulator.rest();
            Setpoint::default()
        } else {
            // Pushed off its goal, or with a new aim, the law starts afresh.
            let afresh = was_resting || new_aim;
            let advance = if afresh { None } else { two_per_dt };
            let (aim, far) = self.aim::<M>(motion, error, distance);
            let command = &moving.command.twist;
            self.regulator
                .advance::<U, M>(motion, &aim, far, command, advance)
        };
        Wanted {
            setpoint,
            rebase: new_aim || resting != was_resting,
        }
    }

    /// What to drive at, and how far it is: the goal, or the place that a retry drives out to.
    fn aim<M: Maths<T>>(
        &self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
        distance: T,
    ) -> (PoseError<T>, T) {
        if self.retry.is_out() {
            let aim = self.retry.aim::<M>(motion, error);
            let far = distance_of::<T, M>(&aim);
            (aim, far)
        } else {
            (*error, distance)
        }
    }

    /// Another goal: all approaches are to be had again.
    pub(crate) fn renew_retries(&mut self) {
        self.retry = Retry::default();
    }

    /// Nothing is asked for any more: parked, or given up.
    pub(crate) fn is_resting(&self) -> bool {
        self.checker.parked || self.retry.given_up
    }

    /// At the goal within tolerance.
    pub(crate) fn is_parked(&self) -> bool {
        self.checker.parked
    }

    /// At rest outside of the tolerance, after all retries.
    pub(crate) fn has_given_up(&self) -> bool {
        self.retry.given_up
    }

    /// New approaches so far.
    pub(crate) fn retries(&self) -> u8 {
        self.retry.count
    }

    /// While parking: the robot backs up.
    pub(crate) fn is_backing(&self) -> bool {
        self.regulator.is_backing()
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.follower.is_finite() && self.regulator.is_finite()
    }
}
