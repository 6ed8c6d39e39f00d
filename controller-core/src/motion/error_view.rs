//! Where the reference or the goal is, as the robot sees it, and whether that jumped.

use super::manoeuvre::GoalSeen;
use super::params::MotionParams;
use super::task::Task;
use crate::angle::wrap;
use crate::maths::Maths;
use crate::pose_error::{PoseError, pose_error_and_heading, tracking_error};
use crate::scalar::Scalar;
use crate::types::Pose;

/// The pose error of a task.
#[derive(Clone, Copy)]
pub(crate) struct ErrorView<T> {
    pub(crate) error: PoseError<T>,
    /// (sin e_θ, cos e_θ) while following, (sin θ, cos θ) of the robot while parking.
    pub(crate) heading: (T, T),
    /// How fast the reference moves \[m/s\]; 0 for a goal.
    reference_speed: T,
}

impl<T: Scalar> ErrorView<T> {
    /// `turned` is asked for the heading error of a robot that drives by velocity.
    #[inline(always)]
    pub(crate) fn of<M: Maths<T>>(
        task: &Task<T>,
        pose: &Pose<T>,
        turned: impl FnOnce() -> T,
    ) -> Self {
        match task {
            Task::Follow(reference) => {
                let (error, heading) = tracking_error::<T, M>(reference, pose);
                let reference_speed = reference.twist().linear.abs();
                Self {
                    error,
                    heading,
                    reference_speed,
                }
            }
            Task::Park(goal) => {
                let (error, heading) = pose_error_and_heading::<T, M>(goal, pose);
                Self {
                    error,
                    heading,
                    reference_speed: T::ZERO,
                }
            }
            Task::Drive { .. } => Self {
                error: PoseError {
                    theta: turned(),
                    ..PoseError::default()
                },
                heading: (T::ZERO, T::ONE),
                reference_speed: T::ZERO,
            },
        }
    }

    /// Of a goal, as a manoeuvre sees it.
    #[inline(always)]
    pub(crate) const fn goal(&self) -> GoalSeen<'_, T> {
        GoalSeen {
            error: &self.error,
            heading: self.heading,
        }
    }

    /// In `dt` the error moved further from the `last` one than robot and reference can.
    pub(crate) fn has_jumped<M: Maths<T>>(
        &self,
        last: &PoseError<T>,
        params: &MotionParams<T>,
        dt: T,
    ) -> bool {
        let Some(threshold) = params.jump else {
            return false;
        };
        let (error, limits) = (&self.error, &params.limits);
        // The robot and the reference move, and the frame turns under the error.
        let (dx, dy) = (error.x - last.x, error.y - last.y);
        let reach = M::sqrt(last.x * last.x + last.y * last.y);
        let moved = dt * (limits.speed + self.reference_speed + limits.turn_rate * reach);
        let turned = (T::ONE + T::ONE) * dt * limits.turn_rate;
        let heading = wrap(error.theta - last.theta).abs();
        M::sqrt(dx * dx + dy * dy) > threshold.distance_m + moved
            || heading > threshold.heading_rad + turned
    }
}
