//! Plain backstepping as a complete controller: the baseline. Eqs. (10)-(14).

use crate::backstepping::{
    parking_command, parking_command_rate, tracking_command, tracking_command_rate,
};
use crate::demand::{Demand, check_measured, check_step};
use crate::error::StepFault;
use crate::handover::wrench_step;
use crate::maths::{Libm, Maths};
use crate::output::report;
use crate::params::Validated;
use crate::pose_error::{PoseError, pose_error};
use crate::reference::Reference;
use crate::report::{Notes, Phase, StepReport};
use crate::scalar::Scalar;
use crate::torque;
use crate::types::{Accel, Measured, Pose, Twist, Wrench};
use core::marker::PhantomData;

/// Backstepping without neurons: no memory but the goal, and jumps wherever an error jumps.
///
/// Same calls, parameters and reports as [`crate::neural::NeuralController`]; the neurons' fields
/// of the report are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainController<T = f32, M = Libm> {
    params: Validated<T>,
    goal: Option<Pose<T>>,
    back_end: PhantomData<M>,
}

/// What a law made of an instant.
struct Output<T> {
    error: PoseError<T>,
    command: Twist<T>,
    command_rate: Accel<T>,
    velocity_error: Twist<T>,
    wrench: Wrench<T>,
}

impl<T: Scalar, M: Maths<T>> PlainController<T, M> {
    /// Starts tracking. The first torque is what the errors make it: it jumps from zero.
    ///
    /// # Errors
    /// An input that is not finite, or so large that a torque is not.
    pub fn start(
        params: &Validated<T>,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> Result<(Self, StepReport<T>), StepFault> {
        check_measured(measured)?;
        Demand::Track(*reference).check()?;
        let controller = Self {
            params: *params,
            goal: None,
            back_end: PhantomData,
        };
        let output = controller.track(reference, measured);
        let report = controller.finish(Phase::Tracking, output, None)?;
        Ok((controller, report))
    }

    /// One tick. The law has no memory of time: `dt` is only checked, as the neural one checks it.
    ///
    /// # Errors
    /// Any [`StepFault`]; the state is then unchanged, and the wheels are the caller's to make safe.
    pub fn step(
        &mut self,
        dt: T,
        demand: &Demand<T>,
        measured: &Measured<T>,
    ) -> Result<StepReport<T>, StepFault> {
        check_step(dt, self.params.params.max_tick_s, demand, measured)?;
        match (demand, self.goal) {
            (Demand::Track(reference), None) => {
                self.finish(Phase::Tracking, self.track(reference, measured), None)
            }
            (Demand::Park, Some(goal)) => {
                self.finish(Phase::Parking, self.park(&goal, measured), None)
            }
            (Demand::HandOver { reference, goal }, None) => {
                let old = self.track(reference, measured);
                let new = self.park(goal, measured);
                let jump = wrench_step(&new.wrench, &old.wrench);
                let report = self.finish(Phase::Parking, new, Some(jump))?;
                self.goal = Some(*goal);
                Ok(report)
            }
            _ => Err(StepFault::WrongPhase),
        }
    }

    /// The law in force.
    pub fn phase(&self) -> Phase {
        match self.goal {
            None => Phase::Tracking,
            Some(_) => Phase::Parking,
        }
    }

    /// Eqs. (10) and (12).
    fn track(&self, reference: &Reference<T>, measured: &Measured<T>) -> Output<T> {
        let gains = &self.params.params.tracking;
        let error = pose_error::<T, M>(&reference.pose, &measured.pose);
        let heading = M::sin_cos(error.theta);
        let command = tracking_command(gains, &reference.twist, heading, &error);
        let rate = tracking_command_rate(gains, reference, heading, &error, &measured.twist);
        self.output(error, command, rate, measured, (gains.k_d1, gains.k_d2))
    }

    /// Eqs. (13) and (14).
    fn park(&self, goal: &Pose<T>, measured: &Measured<T>) -> Output<T> {
        let gains = &self.params.params.parking;
        let error = pose_error::<T, M>(goal, &measured.pose);
        let heading = M::sin_cos(error.theta);
        let command = parking_command(gains, heading, &error);
        let rate = parking_command_rate(gains, heading, &error, &measured.twist);
        self.output(error, command, rate, measured, (gains.k_c1, gains.k_c2))
    }

    fn output(
        &self,
        error: PoseError<T>,
        command: Twist<T>,
        command_rate: Accel<T>,
        measured: &Measured<T>,
        gain: (T, T),
    ) -> Output<T> {
        let velocity_error = Twist {
            linear: measured.twist.linear - command.linear,
            angular: measured.twist.angular - command.angular,
        };
        let robot = &self.params.params.robot;
        Output {
            error,
            command,
            command_rate,
            velocity_error,
            wrench: torque::wrench(robot, gain, &velocity_error, &command_rate),
        }
    }

    fn finish(
        &self,
        phase: Phase,
        output: Output<T>,
        jump: Option<Wrench<T>>,
    ) -> Result<StepReport<T>, StepFault> {
        report(
            &self.params,
            StepReport {
                phase,
                error: output.error,
                command: output.command,
                command_rate: output.command_rate,
                velocity_error: output.velocity_error,
                wrench: output.wrench,
                wrench_step: jump.unwrap_or_default(),
                notes: Notes {
                    handed_over: jump.is_some(),
                    ..Notes::default()
                },
                ..StepReport::default()
            },
        )
    }
}
