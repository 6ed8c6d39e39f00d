//! The continuous closed loop, by the classical Runge-Kutta method with a small fixed step.

use nalgebra::Vector2;

use super::{OracleLaw, OracleRow, Phase, Scenario, State, Trace, neuron};

/// Step whose torque differs by 2e-8 from that of one twenty times finer, in the worst of the paper's runs \[s\].
///
/// The kinks of S⁺ and S⁻ in Eq. (5) limit it: 0.25 ms gives 3e-7.
pub const STEP: f64 = 0.1e-3;

/// Rate of the whole loop: Eq. (1), Eq. (3), Eq. (6), Eq. (17), Eq. (22).
pub fn rate(scenario: &Scenario, phase: Phase, t: f64, state: &State) -> State {
    let row = scenario.row(phase, t, state);
    let accel = match scenario.law {
        OracleLaw::Neural => neuron::rates(&scenario.params, &state.accel, &row.command.rate),
        OracleLaw::Plain => Vector2::zeros(),
    };
    State {
        s: row.s_rate,
        accel,
        ..scenario.plant_rate(phase, t, state, &row.tau)
    }
}

/// One step of the classical Runge-Kutta method for any rate of the state.
pub fn runge_kutta(rate: impl Fn(f64, &State) -> State, t: f64, state: &State, h: f64) -> State {
    let k1 = rate(t, state);
    let k2 = rate(t + h / 2.0, &state.along(&k1, h / 2.0));
    let k3 = rate(t + h / 2.0, &state.along(&k2, h / 2.0));
    let k4 = rate(t + h, &state.along(&k3, h));
    state
        .along(&k1, h / 6.0)
        .along(&k2, h / 3.0)
        .along(&k3, h / 3.0)
        .along(&k4, h / 6.0)
}

/// The state at `end`, in equal steps no longer than `step`.
pub fn advance(
    scenario: &Scenario,
    phase: Phase,
    start: f64,
    end: f64,
    state: &State,
    step: f64,
) -> State {
    let steps = ((end - start) / step).ceil().max(1.0);
    let h = (end - start) / steps;
    (0..steps as usize).fold(*state, |state, i| {
        runge_kutta(
            |t, state| rate(scenario, phase, t, state),
            start + i as f64 * h,
            &state,
            h,
        )
    })
}

/// Runs the loop and returns a row at each of `times`, hit exactly.
///
/// `times` ascend within the run. If there is a switch, two rows at P (before, after) are always returned and a
/// request for P itself is ignored.
pub fn run(scenario: &Scenario, times: &[f64], step: f64) -> Trace {
    assert!(times.is_sorted(), "requested times must ascend");
    let mut walk = Walk {
        scenario,
        phase: Phase::Tracking,
        t: 0.0,
        state: scenario.initial_state(),
        step,
        rows: Vec::new(),
    };
    let Some(switch) = scenario.switch else {
        times.iter().for_each(|&t| walk.record(t));
        return Trace {
            rows: walk.rows,
            switch: None,
        };
    };
    for &t in times.iter().filter(|&&t| t < switch.at) {
        walk.record(t);
    }
    walk.record(switch.at);
    let before = walk.row();
    walk.phase = Phase::Parking;
    walk.state = scenario.switched(&switch, &before, &walk.state);
    walk.record(switch.at);
    let after = walk.row();
    for &t in times.iter().filter(|&&t| t > switch.at) {
        walk.record(t);
    }
    Trace {
        rows: walk.rows,
        switch: Some((before, after)),
    }
}

/// A loop under way, with the rows recorded so far.
struct Walk<'a> {
    scenario: &'a Scenario,
    phase: Phase,
    t: f64,
    state: State,
    step: f64,
    rows: Vec<OracleRow>,
}

impl Walk<'_> {
    fn row(&self) -> OracleRow {
        self.scenario.row(self.phase, self.t, &self.state)
    }

    fn record(&mut self, t: f64) {
        if t > self.t {
            self.state = advance(self.scenario, self.phase, self.t, t, &self.state, self.step);
            self.t = t;
        }
        self.rows.push(self.row());
    }
}
