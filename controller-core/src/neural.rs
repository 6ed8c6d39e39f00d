//! The paper's controller: tracking and parking through shunting neurons, in sampled time.

use crate::demand::{Demand, check_measured, check_step};
use crate::error::StepFault;
use crate::handover::{TorqueBefore, acceleration_neurons, pose_neurons, wrench_step};
use crate::maths::{Libm, Maths};
use crate::neural_law::{LawOutput, NeuralState, park, track};
use crate::output::report;
use crate::params::Validated;
use crate::pose_error::pose_error;
use crate::reference::Reference;
use crate::report::{NeuronStates, Notes, Phase, StepReport};
use crate::scalar::Scalar;
use crate::shunting::{ExactMean, NeuronUpdate};
use crate::tracking::start;
use crate::types::{Accel, Measured, Pose, Twist, Wrench};
use core::marker::PhantomData;

/// Tracks a reference and parks at a pose, with velocities and torques that start from what they
/// are and do not jump at the hand-over. Eqs. (15)-(23).
///
/// * `T`: `f32` on a chip, `f64` to prove formulas.
/// * `M`: mathematical back end.
/// * `U`: how the neurons are advanced over a tick.
///
/// ```
/// use controller_core::demand::Demand;
/// use controller_core::maths::Libm;
/// use controller_core::neural::NeuralController;
/// use controller_core::params::Params;
/// use controller_core::reference::ConstantTwist;
/// use controller_core::types::{Measured, Pose, Twist};
///
/// let line = ConstantTwist { start: Pose::default(), twist: Twist::new(0.4, 0.0) };
/// let mut measured = Measured { pose: Pose::new(0.0, 1.0, 0.0), ..Measured::default() };
/// let params = Params::<f32>::paper().validate()?;
/// let (mut controller, first): (NeuralController, _) =
///     NeuralController::start(&params, &line.at::<Libm>(0.0), &measured)?;
/// assert_eq!(first.torques.right, 0.0);
/// measured.twist.linear = 0.01; // … a tick later, from the encoders
/// let report = controller.step(0.01, &Demand::Track(line.at::<Libm>(0.01)), &measured)?;
/// assert!(report.torques.right.is_finite());
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeuralController<T = f32, M = Libm, U = ExactMean> {
    params: Validated<T>,
    memory: Memory<T>,
    back_ends: PhantomData<(M, U)>,
}

/// What changes from tick to tick; copied first and stored last, so that a fault changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Memory<T> {
    state: NeuralState<T>,
    /// Where to park; `None` while tracking.
    goal: Option<Pose<T>>,
    /// Inputs of the pose neurons at the last tick.
    drives: (T, T),
    /// Inputs of the acceleration neurons at the last tick.
    command_rate: Accel<T>,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> NeuralController<T, M, U> {
    /// Bridge terms below this \[m/s, rad/s\] are dropped. It is below the rounding of any command
    /// above 1e-5 in single precision, and times k_d = 1e3 a torque of 1e-9 N.
    const BRIDGE_FLOOR: f64 = 1.0e-12;

    /// Starts tracking: the first command is the measured twist, the first torque 0. Eqs. (18), (19).
    ///
    /// `reference` is where the reference is now. Any pose error, any measured twist and any
    /// reference speed will do; the report's `bridging` tells when (18) could not be met as printed.
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
        let error = pose_error::<T, M>(&reference.pose, &measured.pose);
        let heading = M::sin_cos(error.theta);
        let gains = &params.params.tracking;
        let first = start(
            gains,
            &params.shunting,
            &reference.twist,
            heading,
            &measured.twist,
        );
        let state = NeuralState {
            s1: first.s1,
            s_turn: first.s2,
            accel: Accel::default(), // Eq. (19)
            bridge: first.bridge,
        };
        let output = track(params, &state, reference, measured, error, heading);
        let wrench = output.tracking_wrench(params, &state.accel);
        let memory = Memory {
            state,
            goal: None,
            drives: output.drives,
            command_rate: output.command_rate,
        };
        let controller = Self {
            params: *params,
            memory,
            back_ends: PhantomData,
        };
        let report = controller.finish(&memory, &output, wrench, None)?;
        Ok((controller, report))
    }

    /// One tick: advances the neurons over the measured time `dt` \[s\], then computes the torques
    /// for the present instant.
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
        let mut memory = self.memory;
        self.fade_bridge(&mut memory.state, dt);
        let (output, wrench, jump) = match (demand, memory.goal) {
            (Demand::Track(reference), None) => {
                let output = self.track(&mut memory, dt, reference, measured);
                let wrench = output.tracking_wrench(&self.params, &memory.state.accel);
                (output, wrench, None)
            }
            (Demand::Park, Some(goal)) => {
                let output = self.park(&mut memory, dt, &goal, measured);
                let wrench = output.parking_wrench(&self.params, &memory.state.accel);
                (output, wrench, None)
            }
            (Demand::HandOver { reference, goal }, None) => {
                let before = self.track(&mut memory, dt, reference, measured);
                let old = before.tracking_wrench(&self.params, &memory.state.accel);
                let output = self.hand_over(&mut memory, &before, goal, measured);
                let new = output.parking_wrench(&self.params, &memory.state.accel);
                (output, new, Some(wrench_step(&new, &old)))
            }
            _ => return Err(StepFault::WrongPhase),
        };
        memory.drives = output.drives;
        memory.command_rate = output.command_rate;
        let report = self.finish(&memory, &output, wrench, jump)?;
        self.memory = memory;
        Ok(report)
    }

    /// The law in force.
    pub fn phase(&self) -> Phase {
        match self.memory.goal {
            None => Phase::Tracking,
            Some(_) => Phase::Parking,
        }
    }

    /// Neurons and bridge terms as the last tick left them.
    pub fn state(&self) -> &NeuralState<T> {
        &self.memory.state
    }

    fn fade_bridge(&self, state: &mut NeuralState<T>, dt: T) {
        let fade = self.params.shunting.fade::<U, M>(dt);
        let faded = |bridge: T| {
            let next = bridge * fade;
            if next.abs() < T::from_f64(Self::BRIDGE_FLOOR) {
                T::ZERO
            } else {
                next
            }
        };
        state.bridge = Twist {
            linear: faded(state.bridge.linear),
            angular: faded(state.bridge.angular),
        };
    }

    /// Eq. (17) over the tick, then Eq. (15).
    #[inline]
    fn track(
        &self,
        memory: &mut Memory<T>,
        dt: T,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> LawOutput<T> {
        let error = pose_error::<T, M>(&reference.pose, &measured.pose);
        let heading = M::sin_cos(error.theta);
        self.advance_pose(memory, (error.x, error.y), dt);
        let output = track(
            &self.params,
            &memory.state,
            reference,
            measured,
            error,
            heading,
        );
        self.advance_accel(memory, &output.command_rate, dt);
        output
    }

    /// Eq. (22) over the tick, then Eq. (20).
    #[inline]
    fn park(
        &self,
        memory: &mut Memory<T>,
        dt: T,
        goal: &Pose<T>,
        measured: &Measured<T>,
    ) -> LawOutput<T> {
        let error = pose_error::<T, M>(goal, &measured.pose);
        self.advance_pose(memory, (error.x, error.theta), dt);
        let output = park::<T, M>(&self.params, &memory.state, measured, error);
        self.advance_accel(memory, &output.command_rate, dt);
        output
    }

    /// Eq. (23) at the present instant.
    fn hand_over(
        &self,
        memory: &mut Memory<T>,
        before: &LawOutput<T>,
        goal: &Pose<T>,
        measured: &Measured<T>,
    ) -> LawOutput<T> {
        let params = &self.params.params;
        let pose = pose_neurons::<T, M>(&params.parking, &self.params.shunting, &before.command);
        let torque = TorqueBefore {
            velocity_error: before.velocity_error,
            filtered: memory.state.accel,
            command_rate: before.command_rate,
            gain: (params.tracking.k_d1, params.tracking.k_d2),
        };
        memory.goal = Some(*goal);
        memory.state = NeuralState {
            s1: pose.s1,
            s_turn: pose.s3,
            accel: acceleration_neurons(params.reset, &params.robot, &params.parking, &torque),
            bridge: pose.bridge,
        };
        let error = pose_error::<T, M>(goal, &measured.pose);
        park::<T, M>(&self.params, &memory.state, measured, error)
    }

    #[inline]
    fn advance_pose(&self, memory: &mut Memory<T>, now: (T, T), dt: T) {
        let neuron = &self.params.shunting;
        let state = &mut memory.state;
        let (ahead, turn) = memory.drives;
        state.s1 = neuron.advance::<U, M>(state.s1, U::drive(ahead, now.0), dt);
        state.s_turn = neuron.advance::<U, M>(state.s_turn, U::drive(turn, now.1), dt);
    }

    #[inline]
    fn advance_accel(&self, memory: &mut Memory<T>, now: &Accel<T>, dt: T) {
        let neuron = &self.params.shunting;
        let accel = &mut memory.state.accel;
        let last = &memory.command_rate;
        let linear = U::drive(last.linear, now.linear);
        let angular = U::drive(last.angular, now.angular);
        accel.linear = neuron.advance::<U, M>(accel.linear, linear, dt);
        accel.angular = neuron.advance::<U, M>(accel.angular, angular, dt);
    }

    fn finish(
        &self,
        memory: &Memory<T>,
        output: &LawOutput<T>,
        wrench: Wrench<T>,
        jump: Option<Wrench<T>>,
    ) -> Result<StepReport<T>, StepFault> {
        let state = &memory.state;
        let phase = match memory.goal {
            None => Phase::Tracking,
            Some(_) => Phase::Parking,
        };
        let (s2, s3) = match phase {
            Phase::Tracking => (state.s_turn, T::ZERO),
            Phase::Parking => (T::ZERO, state.s_turn),
        };
        let neuron = &self.params.shunting;
        let inside = neuron.contains(state.accel.linear) && neuron.contains(state.accel.angular);
        report(
            &self.params,
            StepReport {
                phase,
                error: output.error,
                neurons: NeuronStates {
                    s1: state.s1,
                    s2,
                    s3,
                    accel: state.accel,
                },
                command: output.command,
                command_rate: output.command_rate,
                velocity_error: output.velocity_error,
                bridge: state.bridge,
                wrench,
                wrench_step: jump.unwrap_or_default(),
                torques: Default::default(),
                notes: Notes {
                    handed_over: jump.is_some(),
                    bridging: state.bridge != Twist::default(),
                    relaxing: !inside,
                    saturated: false,
                },
            },
        )
    }
}
