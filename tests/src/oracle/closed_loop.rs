//! Controller, reference and robot together.

use nalgebra::{Matrix2, Vector2, Vector3};
use serde::Deserialize;

use super::laws::{self, Target};
use super::{OracleRow, Params, Reference, Reset, State, hand_over, neuron, posture, robot};

/// Which control law closes the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OracleLaw {
    /// Backstepping with neurons, Eq. (15) to Eq. (22).
    Neural,
    /// Plain backstepping, Eq. (10) to Eq. (14).
    Plain,
}

/// Before or after the switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Following the moving reference.
    Tracking,
    /// Stabilising at the fixed target, v_r = w_r = 0.
    Parking,
}

/// When, where and how tracking hands over to parking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// Instant P \[s\].
    pub at: f64,
    /// Fixed posture to park at.
    pub target: Vector3<f64>,
    /// Rule for the acceleration neurons.
    pub reset: Reset,
}

/// One closed loop to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenario {
    /// Constants of robot and law.
    pub params: Params,
    /// Control law.
    pub law: OracleLaw,
    /// Reference motion.
    pub reference: Reference,
    /// Posture of the robot at t = 0.
    pub q0: Vector3<f64>,
    /// (v, w) of the robot at t = 0.
    pub twist0: Vector2<f64>,
    /// End of the run \[s\].
    pub duration: f64,
    /// Handover to parking, if any.
    pub switch: Option<Switch>,
    /// What force and moment the robot feels per commanded τ: identity, or [`robot::printed_effort`].
    pub effort: Matrix2<f64>,
}

impl Scenario {
    /// The paper's straight line with P = 9 s, N = 10 s.
    pub fn paper_line() -> Self {
        let heading = std::f64::consts::FRAC_PI_4;
        Self::paper(Reference::steady([0.0, 0.0, heading], 0.4, 0.0), 9.0)
    }

    /// The paper's curve with P = 9.5 s, N = 10 s.
    pub fn paper_curve() -> Self {
        Self::paper(Reference::steady([0.0, 0.0, 0.0], 0.4, 0.15), 9.5)
    }

    fn paper(reference: Reference, switch_at: f64) -> Self {
        Self {
            params: Params::recommended(),
            law: OracleLaw::Neural,
            reference,
            q0: Vector3::new(0.0, 1.0, 0.0),
            twist0: Vector2::zeros(),
            duration: 20.0,
            switch: Some(Switch {
                at: switch_at,
                target: reference.posture(10.0),
                reset: Reset::Corrected,
            }),
            effort: Matrix2::identity(),
        }
    }

    /// State at t = 0: neurons by Eq. (18), acceleration neurons 0 by Eq. (19).
    pub fn initial_state(&self) -> State {
        let q_r = Vector3::from(self.reference.q0);
        let e = posture::error(&q_r, &self.q0);
        let s = match self.law {
            OracleLaw::Neural => {
                let target = self.target(Phase::Tracking, 0.0);
                laws::initial_neurons(&self.params, &target, &e, &self.twist0)
            }
            OracleLaw::Plain => Vector3::zeros(),
        };
        State {
            q: self.q0,
            twist: self.twist0,
            s,
            accel: Vector2::zeros(),
            q_r,
        }
    }

    /// Motion of the reference: Eq. (6) while tracking, at rest while parking.
    pub fn target(&self, phase: Phase, t: f64) -> Target {
        match phase {
            Phase::Tracking => Target {
                twist: self.reference.twist(t),
                accel: self.reference.accel(t),
            },
            Phase::Parking => Target {
                twist: Vector2::zeros(),
                accel: Vector2::zeros(),
            },
        }
    }

    /// 1 for each of (s₁, s₂, s₃) that the law uses in this phase, Eq. (17) and Eq. (22), else 0.
    pub fn active_neurons(&self, phase: Phase) -> Vector3<f64> {
        match (self.law, phase) {
            (OracleLaw::Neural, Phase::Tracking) => Vector3::new(1.0, 1.0, 0.0),
            (OracleLaw::Neural, Phase::Parking) => Vector3::new(1.0, 0.0, 1.0),
            (OracleLaw::Plain, _) => Vector3::zeros(),
        }
    }

    /// Every signal at `t` in this state.
    pub fn row(&self, phase: Phase, t: f64, state: &State) -> OracleRow {
        let p = &self.params;
        let target = self.target(phase, t);
        let e = posture::error(&state.q_r, &state.q);
        let e_rate = posture::error_rate(&e, &state.twist, &target.twist);
        let s = state.s;
        let s_rate = neuron::rates(p, &s, &e).component_mul(&self.active_neurons(phase));
        let command = match (self.law, phase) {
            (OracleLaw::Neural, Phase::Tracking) => {
                laws::neural_tracking(p, &target, &e, &e_rate, &s, &s_rate)
            }
            (OracleLaw::Neural, Phase::Parking) => laws::neural_parking(p, &s, &s_rate),
            (OracleLaw::Plain, Phase::Tracking) => laws::plain_tracking(p, &target, &e, &e_rate),
            (OracleLaw::Plain, Phase::Parking) => laws::plain_parking(p, &e, &e_rate),
        };
        let gain = match phase {
            Phase::Tracking => p.tracking_gain(),
            Phase::Parking => p.parking_gain(),
        };
        let accel = match self.law {
            OracleLaw::Neural => state.accel,
            OracleLaw::Plain => command.rate,
        };
        OracleRow {
            t,
            q: state.q,
            twist: state.twist,
            e,
            s,
            s_rate,
            accel: state.accel,
            command,
            tau: laws::torque(p, &gain, &(state.twist - command.velocity), &accel),
        }
    }

    /// Rate of the robot and of the reference under a given τ; the neurons are left alone.
    pub fn plant_rate(&self, phase: Phase, t: f64, state: &State, tau: &Vector2<f64>) -> State {
        State {
            q: robot::posture_rate(&state.q, &state.twist),
            twist: robot::acceleration(&self.params, &(self.effort * tau)),
            s: Vector3::zeros(),
            accel: Vector2::zeros(),
            q_r: robot::posture_rate(&state.q_r, &self.target(phase, t).twist),
        }
    }

    /// State just after the switch, Eq. (23), from the row and the state just before it.
    pub fn switched(&self, switch: &Switch, before: &OracleRow, state: &State) -> State {
        let p = &self.params;
        let (s, accel) = match self.law {
            OracleLaw::Neural => (
                hand_over::pose_neurons(p, &before.command),
                hand_over::accel_neurons(
                    p,
                    switch.reset,
                    &before.command,
                    &state.twist,
                    &state.accel,
                ),
            ),
            OracleLaw::Plain => (Vector3::zeros(), Vector2::zeros()),
        };
        State {
            s,
            accel,
            q_r: switch.target,
            ..*state
        }
    }
}
