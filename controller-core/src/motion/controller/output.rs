//! The end of a tick: torque, the wheels' limit, what it does to the command, the report.

use super::*;

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> MotionController<T, M, U> {
    /// Torque, the wheels' limit, what it does to the command, and the report.
    pub(super) fn finish(
        &mut self,
        mut state: State<T>,
        law: &Law<T>,
        mut limited: Limited,
        jumped: bool,
        measured: &Measured<T>,
        dt: T,
    ) -> Result<&MotionReport<T>, StepFault> {
        let params = self.motion.params();
        let (robot, limits, gains) = (&params.robot, &params.limits, &params.gains);
        let Command { twist, rate } = state.command;
        let velocity_error = measured.twist.minus(&twist);
        let loops = (
            robot.mass_kg * gains.speed_loop,
            robot.inertia_kg_m2 * gains.turn_loop,
        );
        let driving = crate::torque::wrench(robot, loops, &velocity_error, &rate);
        let disturbance = state.observer.estimate;
        let wrench = Wrench {
            force: driving.force - disturbance.force,
            moment: driving.moment - disturbance.moment,
        };
        let finite = wrench.force.is_finite() && wrench.moment.is_finite();
        if !(finite && law.is_finite() && state.is_finite()) {
            return Err(StepFault::Overflow);
        }
        let torque = limits.wheel_torque_nm;
        let (applied, saturated) = share(&self.motion.wheels, &wrench, torque, limits.policy);
        if saturated {
            // Back-calculation: the command that would have asked for just this.
            let (f, n) = (
                (applied.force + disturbance.force) / robot.mass_kg,
                (applied.moment + disturbance.moment) / robot.inertia_kg_m2,
            );
            let v = measured.twist.linear + (f - rate.linear) / gains.speed_loop;
            let w = measured.twist.angular + (n - rate.angular) / gains.turn_loop;
            state.command.twist = Twist {
                linear: clamp(v, limits.speed),
                angular: clamp(w, limits.turn_rate),
            };
        }
        limited.torque = saturated;
        let released = self.is_released(&state, &velocity_error, &wrench, dt);
        state.released = released;
        state.observer.note((!released).then_some(applied));
        let outcome = if state.latch.parked {
            Outcome::Parked
        } else if state.retry.given_up {
            Outcome::OutOfTolerance
        } else if state.stall.is_stalled(&self.motion) {
            Outcome::Stalled
        } else {
            Outcome::Driving
        };
        self.report = MotionReport {
            mode: match state.task {
                Task::Follow(_) => Mode::Following,
                Task::Park(_) => Mode::Parking,
            },
            outcome,
            error: law.error,
            wanted: law.wish.twist,
            wanted_rate: law.wish.rate,
            bridge: Twist {
                linear: state.bridges.0.value,
                angular: state.bridges.1.value,
            },
            command: twist,
            command_rate: rate,
            velocity_error,
            disturbance,
            wrench,
            torques: if released {
                WheelTorques::default()
            } else {
                bounded(&self.motion.wheels.torques(&applied), torque)
            },
            limited,
            jumped,
            backing: state.parker.is_backing(),
            retries: state.retry.count,
        };
        self.state = state;
        Ok(&self.report)
    }

    /// Parked, and to stand without torque.
    pub(super) fn is_letting_go(&self) -> bool {
        self.state.is_resting() && self.motion.params().arrival.at_rest == AtRest::Release
    }

    /// Parked without torque: from when the robot stands and the torque left is a step of less than
    /// L dt, until it is pushed off the goal.
    pub(super) fn is_released(
        &self,
        state: &State<T>,
        velocity_error: &Twist<T>,
        wrench: &Wrench<T>,
        dt: T,
    ) -> bool {
        let still = T::from_f64(1.0e-3);
        let command = &state.command.twist;
        let stands = command.linear.abs() < still
            && command.angular.abs() < still
            && velocity_error.linear.abs() < still
            && velocity_error.angular.abs() < still
            && wrench.force.abs() <= self.motion.force_rate_limit() * dt
            && wrench.moment.abs() <= self.motion.moment_rate_limit() * dt;
        state.is_resting()
            && self.motion.params().arrival.at_rest == AtRest::Release
            && (state.released || stands)
    }
}

/// Clips the last bits that [`share`] may leave above the limit.
fn bounded<T: Scalar>(torques: &WheelTorques<T>, limit: T) -> WheelTorques<T> {
    WheelTorques {
        right: clamp(torques.right, limit),
        left: clamp(torques.left, limit),
    }
}
