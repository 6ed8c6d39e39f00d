//! The tick that changes from tracking to parking. Eq. (23).

use super::NeuralController;
use crate::error::StepFault;
use crate::maths::Maths;
use crate::paper::demand::{Demand, check_step};
use crate::paper::hand_over::{TorqueBefore, acceleration_neurons, pose_neurons, wrench_step};
use crate::paper::neural_law::{NeuralState, park};
use crate::paper::report::{Phase, StepReport};
use crate::pose_error::pose_error;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Measured, Pose};

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> NeuralController<T, M, U> {
    /// Tracking up to the present instant, then Eq. (23) at it.
    #[cold]
    #[inline(never)]
    pub(super) fn hand_over(
        &mut self,
        dt: T,
        reference: &Reference<T>,
        goal: &Pose<T>,
        demand: &Demand<T>,
        measured: &Measured<T>,
    ) -> Result<&StepReport<T>, StepFault> {
        let params = self.params.params;
        check_step(dt, params.max_tick_s, demand, measured)?;
        let (before, old) = self.track(dt, reference, measured);
        let pose = pose_neurons::<T, M>(&params.parking, &self.params.shunting, &old.command);
        let torque = TorqueBefore {
            velocity_error: old.velocity_error,
            filtered: before.accel,
            command_rate: old.command_rate,
            gain: (params.tracking.k_d1, params.tracking.k_d2),
        };
        let state = NeuralState {
            s1: pose.s1,
            s_turn: pose.s3,
            accel: acceleration_neurons(params.reset, &params.robot, &params.parking, &torque),
            transition_offset: pose.transition_offset,
        };
        let error = pose_error::<T, M>(goal, &measured.pose);
        let output = park::<T, M>(&self.params, &state, measured, error);
        let new_wrench = output.parking_wrench(&self.params, &state.accel);
        let old_wrench = old.tracking_wrench(&self.params, &before.accel);
        self.finish(
            Phase::Parking,
            &state,
            &output,
            new_wrench,
            demand,
            measured,
        )?;
        self.report.phase = Phase::Parking;
        self.report.neurons.s2 = T::ZERO;
        self.wrench_step = Some(wrench_step(&new_wrench, &old_wrench));
        self.goal = *goal;
        Ok(&self.report)
    }
}
