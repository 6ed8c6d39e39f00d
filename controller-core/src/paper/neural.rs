//! The paper's controller: tracking and parking through shunting neurons, in sampled time.

use crate::check::{check_measured, check_tick};
use crate::error::StepFault;
use crate::maths::{Maths, Single};
use crate::paper::demand::Demand;
use crate::paper::neural_law::{LawOutput, NeuralState, park, track};
use crate::paper::output::{check_rate, wheel_torques};
use crate::paper::params::ValidParams;
use crate::paper::report::{Phase, StepReport};
use crate::paper::tracking::start;
use crate::pose_error::{PoseError, pose_error, tracking_error};
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::{NeuronUpdate, RationalMean};
use crate::types::{Accel, Measured, Pose, Twist, Wrench};
use core::marker::PhantomData;

mod switch;

/// Tracks a reference and parks at a pose, with velocities and torques that start from what they
/// are and do not jump at the hand-over. Eqs. (15)-(23).
///
/// * `T`: `f32` on a chip, `f64` to prove formulas.
/// * `M`: mathematical back end.
/// * `U`: how the neurons are advanced over a tick.
///
/// The defaults suit a chip with a single-precision floating-point unit.
///
/// ```
/// use controller_core::paper::demand::Demand;
/// use controller_core::maths::Single;
/// use controller_core::paper::neural::NeuralController;
/// use controller_core::paper::params::Params;
/// use controller_core::reference::ConstantTwist;
/// use controller_core::types::{Measured, Pose, Twist};
///
/// let line = ConstantTwist { start: Pose::default(), twist: Twist::new(0.4, 0.0) };
/// let mut measured = Measured { pose: Pose::new(0.0, 1.0, 0.0), ..Measured::default() };
/// let params = Params::<f32>::paper().validate()?;
/// let mut controller: NeuralController =
///     NeuralController::start(&params, &line.at::<Single>(0.0), &measured)?;
/// assert_eq!(controller.report().torques.right, 0.0);
/// measured.twist.linear = 0.01; // … a tick later, from the encoders
/// let report = controller.step(0.01, &Demand::Track(line.at::<Single>(0.01)), &measured)?;
/// assert!(report.torques.right.is_finite());
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeuralController<T = f32, M = Single, U = RationalMean> {
    params: ValidParams<T>,
    /// Where to park; unused while tracking.
    goal: Pose<T>,
    /// The last report is the controller's memory: neurons, transition offsets, and the inputs that the
    /// neurons had. It is written once a tick, at its end, so that a fault changes nothing.
    report: StepReport<T>,
    wrench_step: Option<Wrench<T>>,
    back_ends: PhantomData<(M, U)>,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> NeuralController<T, M, U> {
    /// Starts tracking: the first command is the measured twist, the first torque 0; see
    /// [`report`](Self::report). Eqs. (18), (19).
    ///
    /// `reference` is where the reference is now. Any pose error, any measured twist and any
    /// reference speed will do; [`StepReport::has_transition_offset`] says when (18) could not be met as
    /// printed.
    ///
    /// # Errors
    /// An input that is not finite, or so large that a torque is not.
    pub fn start(
        params: &ValidParams<T>,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> Result<Self, StepFault> {
        let demand = Demand::Track(*reference);
        check_measured(measured)?;
        demand.check()?;
        let (error, heading) = tracking_error::<T, M>(reference, &measured.pose);
        let gains = &params.params.tracking;
        let neuron = &params.shunting;
        let first = start(gains, neuron, reference.twist(), heading, &measured.twist);
        let state = NeuralState {
            s1: first.s1,
            s_turn: first.s2,
            accel: Accel::default(), // Eq. (19)
            transition_offset: first.transition_offset,
        };
        let output = track(params, &state, reference, measured, error, heading);
        // The first torque does not depend on the errors, the next one will.
        check_rate(&output.command_rate, &demand, measured)?;
        let wrench = output.tracking_wrench(params, &state.accel);
        let mut controller = Self {
            params: *params,
            goal: Pose::default(),
            report: StepReport::default(),
            wrench_step: None,
            back_ends: PhantomData,
        };
        controller.finish(Phase::Tracking, &state, &output, wrench, &demand, measured)?;
        Ok(controller)
    }

    /// One tick: advances the neurons over the measured time `dt` \[s\], then computes the torques
    /// for the present instant.
    ///
    /// # Errors
    /// Any [`StepFault`]; the state is then unchanged, and the wheels are the caller's to make safe.
    #[inline(never)]
    pub fn step(
        &mut self,
        dt: T,
        demand: &Demand<T>,
        measured: &Measured<T>,
    ) -> Result<&StepReport<T>, StepFault> {
        check_tick(dt, self.params.params.max_tick_s)?;
        match (demand, self.report.phase) {
            (Demand::Track(reference), Phase::Tracking) => {
                let (state, output) = self.track(dt, reference, measured);
                let wrench = output.tracking_wrench(&self.params, &state.accel);
                self.finish(Phase::Tracking, &state, &output, wrench, demand, measured)
            }
            (Demand::Park, Phase::Parking) => {
                let (state, output) = self.park(dt, measured);
                let wrench = output.parking_wrench(&self.params, &state.accel);
                self.finish(Phase::Parking, &state, &output, wrench, demand, measured)
            }
            (Demand::HandOver { reference, goal }, Phase::Tracking) => {
                self.hand_over(dt, reference, goal, demand, measured)
            }
            _ => Err(StepFault::WrongPhase),
        }
    }

    /// The report of the last tick.
    pub fn report(&self) -> &StepReport<T> {
        &self.report
    }

    /// The step of the wrench at the hand-over: what parking demanded minus what tracking would
    /// have, at the same instant. `None` before; 0 up to rounding with the default reset.
    pub fn hand_over_step(&self) -> Option<Wrench<T>> {
        self.wrench_step
    }

    /// An acceleration neuron was put outside [−D, B] by the hand-over and is on its way back.
    pub fn is_relaxing(&self) -> bool {
        let accel = &self.report.neurons.accel;
        let neuron = &self.params.shunting;
        !(neuron.contains(accel.linear) && neuron.contains(accel.angular))
    }

    /// Neurons and transition offsets as the last tick left them.
    pub fn state(&self) -> NeuralState<T> {
        let StepReport {
            phase,
            neurons,
            transition_offset,
            ..
        } = self.report;
        NeuralState {
            s1: neurons.s1,
            s_turn: match phase {
                Phase::Tracking => neurons.s2,
                Phase::Parking => neurons.s3,
            },
            accel: neurons.accel,
            transition_offset,
        }
    }

    /// Eq. (17) over the tick, then Eq. (15).
    #[inline(always)]
    fn track(
        &self,
        dt: T,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> (NeuralState<T>, LawOutput<T>) {
        let two_per_dt = (T::ONE + T::ONE) / dt;
        let (error, heading) = tracking_error::<T, M>(reference, &measured.pose);
        let turn = (self.report.neurons.s2, self.report.error.y, error.y);
        let mut state = self.advance_pose(&error, turn, two_per_dt);
        let output = track(&self.params, &state, reference, measured, error, heading);
        state.accel = self.advance_accel(&output.command_rate, two_per_dt);
        (state, output)
    }

    /// Eq. (22) over the tick, then Eq. (20).
    #[inline(always)]
    fn park(&self, dt: T, measured: &Measured<T>) -> (NeuralState<T>, LawOutput<T>) {
        let two_per_dt = (T::ONE + T::ONE) / dt;
        let error = pose_error::<T, M>(&self.goal, &measured.pose);
        let turn = (self.report.neurons.s3, self.report.error.theta, error.theta);
        let mut state = self.advance_pose(&error, turn, two_per_dt);
        let output = park::<T, M>(&self.params, &state, measured, error);
        state.accel = self.advance_accel(&output.command_rate, two_per_dt);
        (state, output)
    }

    /// s₁, the turning neuron `(state, last input, input)` and the transition offsets over a tick.
    #[inline(always)]
    fn advance_pose(&self, error: &PoseError<T>, turn: (T, T, T), two_per_dt: T) -> NeuralState<T> {
        let neuron = &self.params.shunting;
        let last = &self.report;
        let ahead = U::twice_input(last.error.x, error.x);
        let around = U::twice_input(turn.1, turn.2);
        let faded = neuron.fading::<U, M>(two_per_dt);
        NeuralState {
            s1: neuron.advance::<U, M>(last.neurons.s1, ahead, two_per_dt),
            s_turn: neuron.advance::<U, M>(turn.0, around, two_per_dt),
            accel: last.neurons.accel,
            transition_offset: Twist {
                linear: last.transition_offset.linear - faded * last.transition_offset.linear,
                angular: last.transition_offset.angular - faded * last.transition_offset.angular,
            },
        }
    }

    /// v̇_s and ẇ_s over a tick.
    #[inline(always)]
    fn advance_accel(&self, now: &Accel<T>, two_per_dt: T) -> Accel<T> {
        let neuron = &self.params.shunting;
        let (last, accel) = (&self.report.command_rate, &self.report.neurons.accel);
        let linear = U::twice_input(last.linear, now.linear);
        let angular = U::twice_input(last.angular, now.angular);
        Accel {
            linear: neuron.advance::<U, M>(accel.linear, linear, two_per_dt),
            angular: neuron.advance::<U, M>(accel.angular, angular, two_per_dt),
        }
    }

    /// Torques, checks, and the report in its place.
    #[inline(always)]
    fn finish(
        &mut self,
        phase: Phase,
        state: &NeuralState<T>,
        output: &LawOutput<T>,
        wrench: Wrench<T>,
        demand: &Demand<T>,
        measured: &Measured<T>,
    ) -> Result<&StepReport<T>, StepFault> {
        if !U::USES_PRESENT_INPUT {
            check_rate(&output.command_rate, demand, measured)?;
        }
        let (torques, saturated) = wheel_torques(&self.params, &wrench, demand, measured)?;
        let report = &mut self.report;
        report.error = output.error;
        report.neurons.s1 = state.s1;
        match phase {
            Phase::Tracking => report.neurons.s2 = state.s_turn,
            Phase::Parking => report.neurons.s3 = state.s_turn,
        }
        report.neurons.accel = state.accel;
        report.command = output.command;
        report.command_rate = output.command_rate;
        report.velocity_error = output.velocity_error;
        report.transition_offset = state.transition_offset;
        report.wrench = wrench;
        report.torques = torques;
        report.saturated = saturated;
        Ok(report)
    }
}
