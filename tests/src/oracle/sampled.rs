//! The sampled closed loop: torque held over each sample, neurons advanced exactly with held inputs.

use super::continuous::runge_kutta;
use super::{OracleLaw, OracleRow, Phase, Scenario, State, Trace, neuron};

/// Longest step of the robot's posture inside a sample \[s\]; its velocities are linear there, hence exact.
pub const PLANT_STEP: f64 = 0.25e-3;

/// Slack that lets a sample at k dt count as having reached P in spite of rounding \[s\].
pub const SWITCH_SLACK: f64 = 1e-9;

/// The state one sample later: τ of `row` held, the robot and reference moved, then every neuron advanced.
pub fn advance(
    scenario: &Scenario,
    phase: Phase,
    row: &OracleRow,
    state: &State,
    dt: f64,
) -> State {
    let p = &scenario.params;
    let steps = (dt / PLANT_STEP).ceil().max(1.0);
    let h = dt / steps;
    let moved = (0..steps as usize).fold(*state, |state, i| {
        runge_kutta(
            |t, state| scenario.plant_rate(phase, t, state, &row.tau),
            row.t + i as f64 * h,
            &state,
            h,
        )
    });
    let s = neuron::held_all(p, &state.s, &row.e, dt);
    let accel = match scenario.law {
        OracleLaw::Neural => neuron::held_all(p, &state.accel, &row.command.rate, dt),
        OracleLaw::Plain => state.accel,
    };
    State {
        s: s.component_mul(&scenario.active_neurons(phase)),
        accel,
        ..moved
    }
}

/// Runs the loop with samples at k dt and returns the row of every sample.
///
/// The switch is made at the first sample that has reached P, before its torque is computed; that sample's row is the
/// one after the switch.
pub fn run(scenario: &Scenario, dt: f64) -> Trace {
    let samples = (scenario.duration / dt).round() as usize;
    let mut phase = Phase::Tracking;
    let mut state = scenario.initial_state();
    let mut trace = Trace {
        rows: Vec::with_capacity(samples + 1),
        switch: None,
    };
    for k in 0..=samples {
        let t = k as f64 * dt;
        let mut row = scenario.row(phase, t, &state);
        if let (Phase::Tracking, Some(switch)) = (phase, &scenario.switch)
            && t >= switch.at - SWITCH_SLACK
        {
            let before = row;
            phase = Phase::Parking;
            state = scenario.switched(switch, &before, &state);
            row = scenario.row(phase, t, &state);
            trace.switch = Some((before, row));
        }
        trace.rows.push(row);
        state = advance(scenario, phase, &row, &state, dt);
    }
    trace
}
