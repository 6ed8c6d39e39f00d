//! What a controller remembers, and what passes between the parts of a tick.

use super::*;

/// What changes from tick to tick; copied first and stored last, so that a fault changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State<T> {
    pub(super) task: Task<T>,
    pub(super) follower: Follower<T>,
    pub(super) parker: Parker<T>,
    pub(super) latch: Latch<T>,
    pub(super) stall: Stall<T>,
    pub(super) retry: Retry<T>,
    pub(super) observer: Observer<T>,
    /// Of speed and turn rate.
    pub(super) bridges: (Bridge<T>, Bridge<T>),
    pub(super) command: Command<T>,
    /// The caller said that the pose will jump.
    pub(super) declared: bool,
    /// Parked without torque: the command is what the robot does by itself.
    pub(super) released: bool,
}

impl<T: Scalar> State<T> {
    /// Nothing is wanted any more: parked, or given up.
    pub(super) fn is_resting(&self) -> bool {
        self.latch.parked || self.retry.given_up
    }

    /// No memory is infinite or NaN: a wild input is refused, and does not stay.
    pub(super) fn is_finite(&self) -> bool {
        let (linear, angular) = &self.bridges;
        self.observer.is_finite()
            && self.follower.is_finite()
            && self.parker.is_finite()
            && linear.is_finite()
            && angular.is_finite()
    }
}

/// Where the goal or the reference is, as the robot sees it.
pub(super) struct Sight<T> {
    pub(super) error: PoseError<T>,
    /// (sin e_θ, cos e_θ) while following.
    pub(super) heading: (T, T),
}

impl<T: Scalar> Sight<T> {
    pub(super) fn of<M: Maths<T>>(task: &Task<T>, measured: &Measured<T>) -> Self {
        let (error, heading) = match task {
            Task::Follow(reference) => tracking_error::<T, M>(reference, &measured.pose),
            Task::Park(goal) => {
                let error = pose_error::<T, M>(goal, &measured.pose);
                (error, (T::ZERO, T::ONE))
            }
        };
        Self { error, heading }
    }
}

/// What a pose law made of an instant.
pub(super) struct Law<T> {
    pub(super) wish: Wish<T>,
    pub(super) error: PoseError<T>,
    /// Following and parking, parked and not: a change starts a new bridge.
    pub(super) rebase: bool,
}

impl<T: Scalar> Law<T> {
    pub(super) fn is_finite(&self) -> bool {
        let Wish { twist, rate } = &self.wish;
        let error = &self.error;
        let error = error.x.is_finite() && error.y.is_finite() && error.theta.is_finite();
        error && twist.is_finite() && rate.is_finite()
    }
}
