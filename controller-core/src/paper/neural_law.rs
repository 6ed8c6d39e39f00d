//! The paper's neural laws as functions of state: for the sampled controller, and for anyone who
//! integrates them in continuous time. Eqs. (15)-(17) and (20)-(22).

use crate::maths::Maths;
use crate::paper::params::ValidParams;
use crate::paper::{parking, tracking};
use crate::pose_error::{PoseError, pose_error, tracking_error};
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::torque;
use crate::types::{Accel, Measured, Pose, Twist, Wrench};

/// The controller's memory: four neurons and two transition offsets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NeuralState<T> {
    /// s₁, of e_x.
    pub s1: T,
    /// s₂, of e_y, while tracking; s₃, of e_θ, while parking.
    pub s_turn: T,
    /// (v̇_s, ẇ_s).
    pub accel: Accel<T>,
    /// (b_v, b_w).
    pub transition_offset: Twist<T>,
}

/// What a law makes of a state and a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawOutput<T> {
    /// e_p, Eq. (8).
    pub error: PoseError<T>,
    /// Inputs of the neurons s₁ and s₂ (s₃).
    pub drives: (T, T),
    /// (v_c, w_c).
    pub command: Twist<T>,
    /// (v̇_c, ẇ_c): the inputs of the acceleration neurons.
    pub command_rate: Accel<T>,
    /// (v − v_c, w − w_c).
    pub velocity_error: Twist<T>,
}

impl<T: Scalar> LawOutput<T> {
    /// Eqs. (17) and (22): rates of change of all states.
    pub fn state_rate(&self, params: &ValidParams<T>, state: &NeuralState<T>) -> NeuralState<T> {
        let neuron = &params.shunting;
        NeuralState {
            s1: neuron.rate(state.s1, self.drives.0),
            s_turn: neuron.rate(state.s_turn, self.drives.1),
            accel: Accel {
                linear: neuron.rate(state.accel.linear, self.command_rate.linear),
                angular: neuron.rate(state.accel.angular, self.command_rate.angular),
            },
            transition_offset: Twist {
                linear: neuron.rate(state.transition_offset.linear, T::ZERO),
                angular: neuron.rate(state.transition_offset.angular, T::ZERO),
            },
        }
    }

    /// Eq. (16): the wrench while tracking.
    #[inline(always)]
    pub fn tracking_wrench(&self, params: &ValidParams<T>, accel: &Accel<T>) -> Wrench<T> {
        let gains = &params.params.tracking;
        let gain = (gains.k_d1, gains.k_d2);
        torque::wrench(&params.params.robot, gain, &self.velocity_error, accel)
    }

    /// Eq. (21): the wrench while parking.
    #[inline(always)]
    pub fn parking_wrench(&self, params: &ValidParams<T>, accel: &Accel<T>) -> Wrench<T> {
        let gains = &params.params.parking;
        let gain = (gains.k_c1, gains.k_c2);
        torque::wrench(&params.params.robot, gain, &self.velocity_error, accel)
    }
}

/// The tracking law at one instant. Eq. (15) and its rate.
#[inline(always)]
pub fn tracking_law<T: Scalar, M: Maths<T>>(
    params: &ValidParams<T>,
    state: &NeuralState<T>,
    reference: &Reference<T>,
    measured: &Measured<T>,
) -> LawOutput<T> {
    let (error, heading) = tracking_error::<T, M>(reference, &measured.pose);
    track(params, state, reference, measured, error, heading)
}

/// [`tracking_law`] with the pose error at hand.
#[inline(always)]
pub(crate) fn track<T: Scalar>(
    params: &ValidParams<T>,
    state: &NeuralState<T>,
    reference: &Reference<T>,
    measured: &Measured<T>,
    error: PoseError<T>,
    heading: (T, T),
) -> LawOutput<T> {
    let gains = &params.params.tracking;
    let drives = (error.x, error.y);
    let rates = neuron_rates(params, state, drives);
    let turn_rate = measured.twist.angular;
    assemble(
        params,
        state,
        measured,
        error,
        drives,
        tracking::command(gains, reference.twist(), heading, state.s1, state.s_turn),
        tracking::command_rate(gains, reference, heading, turn_rate, state.s_turn, rates),
    )
}

/// The parking law at one instant. Eq. (20) and its rate.
#[inline(always)]
pub fn parking_law<T: Scalar, M: Maths<T>>(
    params: &ValidParams<T>,
    state: &NeuralState<T>,
    goal: &Pose<T>,
    measured: &Measured<T>,
) -> LawOutput<T> {
    let error = pose_error::<T, M>(goal, &measured.pose);
    park::<T, M>(params, state, measured, error)
}

/// [`parking_law`] with the pose error at hand.
#[inline(always)]
pub(crate) fn park<T: Scalar, M: Maths<T>>(
    params: &ValidParams<T>,
    state: &NeuralState<T>,
    measured: &Measured<T>,
    error: PoseError<T>,
) -> LawOutput<T> {
    let gains = &params.params.parking;
    let drives = (error.x, error.theta);
    let rates = neuron_rates(params, state, drives);
    let turn = M::sin_cos_near(state.s_turn);
    assemble(
        params,
        state,
        measured,
        error,
        drives,
        parking::command(gains, state.s1, turn),
        parking::command_rate(gains, turn, rates),
    )
}

#[inline(always)]
fn neuron_rates<T: Scalar>(
    params: &ValidParams<T>,
    state: &NeuralState<T>,
    drives: (T, T),
) -> (T, T) {
    let neuron = &params.shunting;
    (
        neuron.rate(state.s1, drives.0),
        neuron.rate(state.s_turn, drives.1),
    )
}

/// Adds the transition offsets, which fade as db/dt = −A b, and forms the velocity error.
#[inline(always)]
fn assemble<T: Scalar>(
    params: &ValidParams<T>,
    state: &NeuralState<T>,
    measured: &Measured<T>,
    error: PoseError<T>,
    drives: (T, T),
    shaped: Twist<T>,
    shaped_rate: Accel<T>,
) -> LawOutput<T> {
    let decay = params.shunting.decay();
    let command = Twist {
        linear: shaped.linear + state.transition_offset.linear,
        angular: shaped.angular + state.transition_offset.angular,
    };
    let command_rate = Accel {
        linear: shaped_rate.linear - decay * state.transition_offset.linear,
        angular: shaped_rate.angular - decay * state.transition_offset.angular,
    };
    let velocity_error = measured.twist.minus(&command);
    LawOutput {
        error,
        drives,
        command,
        command_rate,
        velocity_error,
    }
}
