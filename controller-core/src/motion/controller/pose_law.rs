//! What a tick wants: which law, from where, and whether the wish jumped.

use super::*;

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> MotionController<T, M, U> {
    /// A new task, a new goal, a declared jump, or an error that moved further than the robot can.
    pub(super) fn is_jump(&self, dt: T, task: &Task<T>, measured: &Measured<T>) -> bool {
        let changed = match (&self.state.task, task) {
            (Task::Follow(_), Task::Follow(_)) => false,
            (Task::Park(old), Task::Park(new)) => old != new,
            _ => true,
        };
        if changed || self.state.declared {
            return true;
        }
        let Some(threshold) = self.motion.params().jump else {
            return false;
        };
        let (error, speed) = match task {
            Task::Follow(reference) => {
                let (error, _) = tracking_error::<T, M>(reference, &measured.pose);
                (error, reference.twist().linear.abs())
            }
            Task::Park(goal) => (pose_error::<T, M>(goal, &measured.pose), T::ZERO),
        };
        let last = &self.report.error;
        let limits = &self.motion.params().limits;
        // The robot and the reference move, and the frame turns under the error.
        let (dx, dy) = (error.x - last.x, error.y - last.y);
        let reach = M::sqrt(last.x * last.x + last.y * last.y);
        let moved = dt * (limits.speed + speed + limits.turn_rate * reach);
        let turned = (T::ONE + T::ONE) * dt * limits.turn_rate;
        let heading = crate::angle::wrap(error.theta - last.theta).abs();
        M::sqrt(dx * dx + dy * dy) > threshold.distance_m + moved
            || heading > threshold.heading_rad + turned
    }

    pub(super) fn law(
        &self,
        state: &mut State<T>,
        dt: T,
        two_per_dt: Option<T>,
        task: &Task<T>,
        measured: &Measured<T>,
    ) -> Law<T> {
        let motion = &self.motion;
        let command = state.command.twist;
        match task {
            Task::Follow(reference) => {
                let (error, heading) = tracking_error::<T, M>(reference, &measured.pose);
                let now = Instant {
                    reference,
                    error,
                    heading,
                    turn_rate: measured.twist.angular,
                };
                state.latch = Latch::default();
                let wish = state
                    .follower
                    .advance::<U, M>(motion, &now, &command, two_per_dt);
                Law {
                    wish,
                    error,
                    rebase: false,
                }
            }
            Task::Park(goal) => {
                let error = pose_error::<T, M>(goal, &measured.pose);
                let distance = M::sqrt(error.x * error.x + error.y * error.y);
                let was_parked = state.latch.parked;
                if two_per_dt.is_none() {
                    state.latch = Latch::default();
                }
                let standing = Standing {
                    error,
                    distance,
                    twist: measured.twist,
                    command,
                    command_rate: state.command.rate,
                };
                state.latch = state.latch.advance(motion, &standing, dt);
                let parked = state.latch.parked;
                let wish = if parked {
                    state.parker.rest();
                    Wish::default()
                } else {
                    // Pushed off its goal, the law starts afresh.
                    let advance = if was_parked { None } else { two_per_dt };
                    state
                        .parker
                        .advance::<U, M>(motion, &error, distance, &command, advance)
                };
                Law {
                    wish,
                    error,
                    rebase: parked != was_parked,
                }
            }
        }
    }
}
