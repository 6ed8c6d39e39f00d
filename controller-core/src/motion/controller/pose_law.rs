//! What a tick wants: which law, from where, and whether the wish jumped.

use super::*;

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> MotionController<T, M, U> {
    /// Another goal, or from following to parking or back.
    pub(super) fn is_new(&self, task: &Task<T>) -> bool {
        match (&self.state.task, task) {
            (Task::Follow(_), Task::Follow(_)) => false,
            (Task::Park(old), Task::Park(new)) => old != new,
            _ => true,
        }
    }

    /// A new task, a new goal, a declared jump, or an error that moved further than the robot can.
    pub(super) fn is_jump(&self, dt: T, task: &Task<T>, seen: &Sight<T>) -> bool {
        if self.is_new(task) || self.state.declared {
            return true;
        }
        let Some(threshold) = self.motion.params().jump else {
            return false;
        };
        let speed = match task {
            Task::Follow(reference) => reference.twist().linear.abs(),
            Task::Park(_) => T::ZERO,
        };
        let error = &seen.error;
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
        (task, seen): (&Task<T>, &Sight<T>),
        measured: &Measured<T>,
    ) -> Law<T> {
        let motion = &self.motion;
        let command = state.command.twist;
        let error = seen.error;
        match task {
            Task::Follow(reference) => {
                let now = Instant {
                    reference,
                    error,
                    heading: seen.heading,
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
            Task::Park(_) => {
                let distance = distance_of::<T, M>(&error);
                let (was_parked, was_resting) = (state.latch.parked, state.is_resting());
                let standing = Standing {
                    error,
                    distance,
                    twist: measured.twist,
                    command,
                    command_rate: state.command.rate,
                    backing: state.parker.is_backing(),
                };
                state.latch = match (two_per_dt, state.retry.may_park()) {
                    (Some(_), true) => state.latch.advance(motion, &standing, dt),
                    (None, true) => Latch::default().advance(motion, &standing, dt),
                    (_, false) => Latch::default(),
                };
                let rest = match (was_parked && two_per_dt.is_some(), state.latch.parked) {
                    (_, true) => Rest::Parked,
                    (true, false) => Rest::Lost,
                    (false, false) => Rest::Moving,
                };
                let (retry, new_aim) = state.retry.advance::<M>(motion, &standing, rest, dt);
                state.retry = retry;
                let resting = state.is_resting();
                let wish = if resting {
                    state.parker.rest();
                    Wish::default()
                } else {
                    // Pushed off its goal, or with a new aim, the law starts afresh.
                    let afresh = was_resting || new_aim;
                    let advance = if afresh { None } else { two_per_dt };
                    let (aim, far) = self.aim(&state.retry, &error, distance);
                    state
                        .parker
                        .advance::<U, M>(motion, &aim, far, &command, advance)
                };
                Law {
                    wish,
                    error,
                    rebase: new_aim || resting != was_resting,
                }
            }
        }
    }

    /// What to drive at, and how far it is: the goal, or the place that a retry drives out to.
    fn aim(&self, retry: &Retry<T>, error: &PoseError<T>, distance: T) -> (PoseError<T>, T) {
        if retry.is_out() {
            let aim = retry.aim::<M>(&self.motion, error);
            let far = distance_of::<T, M>(&aim);
            (aim, far)
        } else {
            (*error, distance)
        }
    }
}
