//! Plain backstepping as a complete controller: the baseline. Eqs. (10)-(14).

use crate::check::{check_measured, check_tick};
use crate::error::StepFault;
use crate::maths::{Maths, Single};
use crate::paper::backstepping::{
    parking_command, parking_command_rate, tracking_command, tracking_command_rate,
};
use crate::paper::demand::Demand;
use crate::paper::hand_over::wrench_step;
use crate::paper::output::{check_rate, wheel_torques};
use crate::paper::params::ValidParams;
use crate::paper::report::{Phase, StepReport};
use crate::pose_error::{pose_error, tracking_error};
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::torque;
use crate::types::{Measured, Pose, Wrench};
use core::marker::PhantomData;

/// Backstepping without neurons: no memory but the goal and the last report, and jumps wherever an error jumps.
///
/// Same calls, parameters and reports as [`crate::paper::neural::NeuralController`]; the neurons' fields
/// of the report are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainController<T = f32, M = Single> {
    params: ValidParams<T>,
    /// Where to park; unused while tracking.
    goal: Pose<T>,
    report: StepReport<T>,
    wrench_step: Option<Wrench<T>>,
    back_end: PhantomData<M>,
}

impl<T: Scalar, M: Maths<T>> PlainController<T, M> {
    /// Starts tracking. The first torque, in [`report`](Self::report), is what the errors make it: it
    /// jumps from zero.
    ///
    /// # Errors
    /// An input that is not finite, or so large that a torque is not.
    pub fn start(
        params: &ValidParams<T>,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> Result<Self, StepFault> {
        check_measured(measured)?;
        let mut controller = Self {
            params: *params,
            goal: Pose::default(),
            report: StepReport::default(),
            wrench_step: None,
            back_end: PhantomData,
        };
        controller.report = controller.track(&Demand::Track(*reference), reference, measured)?;
        Ok(controller)
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
    ) -> Result<&StepReport<T>, StepFault> {
        check_tick(dt, self.params.params.max_tick_s)?;
        match (demand, self.report.phase) {
            (Demand::Track(reference), Phase::Tracking) => {
                self.report = self.track(demand, reference, measured)?;
            }
            (Demand::Park, Phase::Parking) => {
                self.report = self.park(demand, &self.goal, measured)?;
            }
            (Demand::HandOver { reference, goal }, Phase::Tracking) => {
                let old = self.track(demand, reference, measured)?;
                let new = self.park(demand, goal, measured)?;
                self.wrench_step = Some(wrench_step(&new.wrench, &old.wrench));
                self.goal = *goal;
                self.report = new;
            }
            _ => return Err(StepFault::WrongPhase),
        }
        Ok(&self.report)
    }

    /// The report of the last tick.
    pub fn report(&self) -> &StepReport<T> {
        &self.report
    }

    /// The step of the wrench at the hand-over: what parking demanded minus what tracking would
    /// have, at the same instant. `None` before.
    pub fn hand_over_step(&self) -> Option<Wrench<T>> {
        self.wrench_step
    }

    /// Eqs. (10) and (12).
    fn track(
        &self,
        demand: &Demand<T>,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> Result<StepReport<T>, StepFault> {
        let gains = &self.params.params.tracking;
        let (error, heading) = tracking_error::<T, M>(reference, &measured.pose);
        let report = StepReport {
            phase: Phase::Tracking,
            error,
            command: tracking_command(gains, reference.twist(), heading, &error),
            command_rate: tracking_command_rate(gains, reference, heading, &error, &measured.twist),
            ..StepReport::default()
        };
        self.finish(report, (gains.k_d1, gains.k_d2), demand, measured)
    }

    /// Eqs. (13) and (14).
    fn park(
        &self,
        demand: &Demand<T>,
        goal: &Pose<T>,
        measured: &Measured<T>,
    ) -> Result<StepReport<T>, StepFault> {
        let gains = &self.params.params.parking;
        let error = pose_error::<T, M>(goal, &measured.pose);
        let heading = M::sin_cos(error.theta);
        let report = StepReport {
            phase: Phase::Parking,
            error,
            command: parking_command(gains, heading, &error),
            command_rate: parking_command_rate(gains, heading, &error, &measured.twist),
            ..StepReport::default()
        };
        self.finish(report, (gains.k_c1, gains.k_c2), demand, measured)
    }

    fn finish(
        &self,
        mut report: StepReport<T>,
        gain: (T, T),
        demand: &Demand<T>,
        measured: &Measured<T>,
    ) -> Result<StepReport<T>, StepFault> {
        report.velocity_error = measured.twist.minus(&report.command);
        check_rate(&report.command_rate, demand, measured)?;
        let robot = &self.params.params.robot;
        report.wrench = torque::wrench(robot, gain, &report.velocity_error, &report.command_rate);
        (report.torques, report.saturated) =
            wheel_torques(&self.params, &report.wrench, demand, measured)?;
        Ok(report)
    }
}
