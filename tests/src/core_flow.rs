//! The core's own continuous rates, integrated together with this crate's robot.

use controller_core::maths::Libm;
use controller_core::paper::backstepping;
use controller_core::paper::hand_over::{TorqueBefore, acceleration_neurons, pose_neurons};
use controller_core::paper::neural_law::{LawOutput, NeuralState, parking_law, tracking_law};
use controller_core::paper::params::ValidParams;
use controller_core::paper::tracking;
use controller_core::pose_error::pose_error;
use controller_core::torque;
use controller_core::types::{Accel, Measured, Twist, Wrench};
use nalgebra::{SVector, Vector2, Vector3};

use crate::core_params::{measured, sample, validated};
use crate::oracle::{OracleLaw, Phase, Reset, Scenario, robot};

/// (q, v, w, q_r, s₁, s₂ or s₃, v̇_s, ẇ_s, b_v, b_w).
pub type State = SVector<f64, 14>;

/// Everything at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// What the law says.
    pub output: LawOutput<f64>,
    /// Rates of the controller's states.
    pub rate: NeuralState<f64>,
    /// (τ₁, τ₂).
    pub wrench: Wrench<f64>,
}

/// A closed loop of the core in continuous time.
pub struct Flow<'a> {
    scenario: &'a Scenario,
    params: ValidParams<f64>,
}

fn neural(state: &State) -> NeuralState<f64> {
    NeuralState {
        s1: state[8],
        s_turn: state[9],
        accel: Accel::new(state[10], state[11]),
        transition_offset: Twist::new(state[12], state[13]),
    }
}

fn set_neural(state: &mut State, neural: &NeuralState<f64>) {
    let NeuralState {
        s1,
        s_turn,
        accel,
        transition_offset,
    } = neural;
    let values = [
        *s1,
        *s_turn,
        accel.linear,
        accel.angular,
        transition_offset.linear,
        transition_offset.angular,
    ];
    state.fixed_rows_mut::<6>(8).copy_from_slice(&values);
}

fn posture(state: &State) -> Vector3<f64> {
    state.fixed_rows::<3>(0).into()
}

fn twist(state: &State) -> Vector2<f64> {
    state.fixed_rows::<2>(3).into()
}

fn target(state: &State) -> Vector3<f64> {
    state.fixed_rows::<3>(5).into()
}

impl<'a> Flow<'a> {
    /// The loop of a scenario.
    pub fn new(scenario: &'a Scenario) -> Self {
        let reset = scenario
            .switch
            .map_or(Reset::Corrected, |switch| switch.reset);
        let params = validated(&scenario.params, reset);
        Self { scenario, params }
    }

    /// State at t = 0: Eq. (18) and Eq. (19).
    pub fn start(&self) -> State {
        let scenario = self.scenario;
        let q_r = Vector3::from(scenario.reference.q0);
        let mut state = State::zeros();
        state.fixed_rows_mut::<3>(0).copy_from(&scenario.q0);
        state.fixed_rows_mut::<2>(3).copy_from(&scenario.twist0);
        state.fixed_rows_mut::<3>(5).copy_from(&q_r);
        if scenario.law == OracleLaw::Neural {
            let reference = sample::<f64>(&q_r, &scenario.target(Phase::Tracking, 0.0));
            let now: Measured<f64> = measured(&scenario.q0, &scenario.twist0);
            let error = pose_error::<f64, Libm>(reference.pose(), &now.pose);
            let gains = &self.params.params().tracking;
            let first = tracking::start(
                gains,
                self.params.shunting(),
                reference.twist(),
                error.theta.sin_cos(),
                &now.twist,
            );
            let first = NeuralState {
                s1: first.s1,
                s_turn: first.s2,
                accel: Accel::default(),
                transition_offset: first.transition_offset,
            };
            set_neural(&mut state, &first);
        }
        state
    }

    /// Commands, rates and torques of a state.
    pub fn snapshot(&self, phase: Phase, t: f64, state: &State) -> Snapshot {
        let now: Measured<f64> = measured(&posture(state), &twist(state));
        let reference = sample::<f64>(&target(state), &self.scenario.target(phase, t));
        let memory = neural(state);
        let params = &self.params;
        let (output, wrench) = match (self.scenario.law, phase) {
            (OracleLaw::Neural, Phase::Tracking) => {
                let output = tracking_law::<f64, Libm>(params, &memory, &reference, &now);
                (output, output.tracking_wrench(params, &memory.accel))
            }
            (OracleLaw::Neural, Phase::Parking) => {
                let output = parking_law::<f64, Libm>(params, &memory, reference.pose(), &now);
                (output, output.parking_wrench(params, &memory.accel))
            }
            (OracleLaw::Plain, _) => {
                let all = params.params();
                let error = pose_error::<f64, Libm>(reference.pose(), &now.pose);
                let heading = error.theta.sin_cos();
                let (track, park) = (&all.tracking, &all.parking);
                let (command, command_rate, gain) = match phase {
                    Phase::Tracking => (
                        backstepping::tracking_command(track, reference.twist(), heading, &error),
                        backstepping::tracking_command_rate(
                            track, &reference, heading, &error, &now.twist,
                        ),
                        (track.k_d1, track.k_d2),
                    ),
                    Phase::Parking => (
                        backstepping::parking_command(park, heading, &error),
                        backstepping::parking_command_rate(park, heading, &error, &now.twist),
                        (park.k_c1, park.k_c2),
                    ),
                };
                let velocity_error = Twist::new(
                    now.twist.linear - command.linear,
                    now.twist.angular - command.angular,
                );
                let wrench = torque::wrench(&all.robot, gain, &velocity_error, &command_rate);
                let output = LawOutput {
                    error,
                    drives: (0.0, 0.0),
                    command,
                    command_rate,
                    velocity_error,
                };
                (output, wrench)
            }
        };
        let rate = match self.scenario.law {
            OracleLaw::Neural => output.state_rate(params, &memory),
            OracleLaw::Plain => NeuralState::default(),
        };
        Snapshot {
            output,
            rate,
            wrench,
        }
    }

    /// Rate of the whole loop.
    pub fn rate(&self, phase: Phase, t: f64, state: &State) -> State {
        let snapshot = self.snapshot(phase, t, state);
        let tau = Vector2::new(snapshot.wrench.force, snapshot.wrench.moment);
        let scenario = self.scenario;
        let reference = scenario.target(phase, t).twist;
        let mut rate = State::zeros();
        rate.fixed_rows_mut::<3>(0)
            .copy_from(&robot::posture_rate(&posture(state), &twist(state)));
        rate.fixed_rows_mut::<2>(3)
            .copy_from(&robot::acceleration(&scenario.params, &tau));
        rate.fixed_rows_mut::<3>(5)
            .copy_from(&robot::posture_rate(&target(state), &reference));
        set_neural(&mut rate, &snapshot.rate);
        rate
    }

    /// The state at `end`, by the classical Runge-Kutta method in steps no longer than `step`.
    pub fn advance(&self, phase: Phase, start: f64, end: f64, state: &State, step: f64) -> State {
        let steps = ((end - start).abs() / step).ceil().max(1.0);
        let h = (end - start) / steps;
        let mut state = *state;
        for i in 0..steps as usize {
            let t = start + i as f64 * h;
            let k1 = self.rate(phase, t, &state);
            let k2 = self.rate(phase, t + h / 2.0, &(state + h / 2.0 * k1));
            let k3 = self.rate(phase, t + h / 2.0, &(state + h / 2.0 * k2));
            let k4 = self.rate(phase, t + h, &(state + h * k3));
            state += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
        state
    }

    /// The state just after the hand-over, Eq. (23), to a target posture.
    pub fn switched(&self, t: f64, state: &State, target: &Vector3<f64>) -> State {
        let mut after = *state;
        after.fixed_rows_mut::<3>(5).copy_from(target);
        if self.scenario.law == OracleLaw::Neural {
            let before = self.snapshot(Phase::Tracking, t, state).output;
            let params = self.params.params();
            let neurons =
                pose_neurons::<f64, Libm>(&params.parking, self.params.shunting(), &before.command);
            let torque = TorqueBefore {
                velocity_error: before.velocity_error,
                filtered: neural(state).accel,
                command_rate: before.command_rate,
                gain: (params.tracking.k_d1, params.tracking.k_d2),
            };
            let first = NeuralState {
                s1: neurons.s1,
                s_turn: neurons.s3,
                accel: acceleration_neurons(params.reset, &params.robot, &params.parking, &torque),
                transition_offset: neurons.transition_offset,
            };
            set_neural(&mut after, &first);
        }
        after
    }

    /// The golden files' columns.
    pub fn columns(&self, phase: Phase, t: f64, state: &State) -> [f64; 20] {
        let Snapshot { output, wrench, .. } = self.snapshot(phase, t, state);
        let (e, c, n) = (&output.error, &output.command, neural(state));
        let (s2, s3) = match phase {
            Phase::Tracking => (n.s_turn, 0.0),
            Phase::Parking => (0.0, n.s_turn),
        };
        #[rustfmt::skip]
        let columns = [
            t, state[0], state[1], state[2], state[3], state[4], e.x, e.y, e.theta, n.s1, s2, s3,
            n.accel.linear, n.accel.angular, c.linear, c.angular, wrench.force, wrench.moment,
            n.transition_offset.linear, n.transition_offset.angular,
        ];
        columns
    }
}
