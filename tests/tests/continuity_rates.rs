//! Resets that do jump, by their formula; rates of the commands, by differences along the flow; torque changes that
//! halve with the tick.

use controller_core::maths::Libm;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::plain::PlainController;
use nalgebra::Vector2;
use proptest::prelude::*;
use tests::check::assert_within;
use tests::core_draw::cases;
use tests::core_draw_loop::scenario;
use tests::core_flow::{Flow, State};
use tests::core_loop::{Controller, Exact, Tick, hand_over, largest_torque_change, run};
use tests::oracle::{OracleLaw, Phase, Reset, Scenario};
use tests::tolerance::{COMMAND_RATE, HALVES, RESET_JUMP};

/// Control period of the runs with a reset \[s\].
const DT: f64 = 5e-3;
/// Half the span of a difference quotient \[s\].
const H: f64 = 1e-5;

/// What a reset does to the torque: the reported step, and what was there before.
fn reset_jump(mut scenario: Scenario, reset: Reset) -> (Vector2<f64>, Tick<f64>) {
    scenario.switch.as_mut().expect("drawn with a switch").reset = reset;
    let ticks = run::<f64, Exact>(&scenario, DT);
    let tick = ticks[hand_over(&ticks)];
    let step = tick.wrench_step.expect("this tick hands over");
    let old = Tick {
        report: tick.unswitched.expect("a copy went on tracking"),
        ..tick
    };
    (Vector2::new(step.force, step.moment), old)
}

/// A state anywhere: neurons inside their bounds, transition offsets at work.
fn states() -> impl Strategy<Value = ([f64; 8], [f64; 6])> {
    (
        prop::array::uniform8(-2.0..2.0_f64),
        prop::array::uniform6(-1.0..1.0_f64),
    )
}

/// Command and its rate in a state.
fn command(flow: &Flow, phase: Phase, t: f64, state: &State) -> (Vector2<f64>, Vector2<f64>) {
    let output = flow.snapshot(phase, t, state).output;
    let (command, rate) = (output.command, output.command_rate);
    (
        Vector2::new(command.linear, command.angular),
        Vector2::new(rate.linear, rate.angular),
    )
}

proptest! {
    #![proptest_config(cases(500))]

    /// Eq. (23) as printed: torque jumps by -(k_c - k_d) δ + M̄ (v̇_c - v̇_s); with zeroed neurons by
    /// -(k_c - k_d) δ - M̄ v̇_s.
    #[test]
    fn other_resets_jump_by_their_formulas(scenario in scenario()) {
        let p = scenario.params;
        for reset in [Reset::Printed, Reset::Zero] {
            let (found, old) = reset_jump(scenario, reset);
            let (delta, accel) = (old.report.velocity_error, old.report.neurons.accel);
            let delta = Vector2::new(delta.linear, delta.angular);
            let kept = match reset {
                Reset::Printed => old.command_rate(),
                _ => Vector2::zeros(),
            };
            let expected = -(p.parking_gain() - p.tracking_gain()) * delta
                + p.mass_matrix() * (kept - Vector2::new(accel.linear, accel.angular));
            prop_assert!((found - expected).amax() <= RESET_JUMP, "{found} {expected}");
        }
    }

    /// Rates of Eq. (15), Eq. (20), Eq. (10) and Eq. (13) are analytic: they are what a difference along the flow finds.
    #[test]
    fn command_rates_are_the_rates_of_the_commands(mut scenario in scenario(), (plant, memory) in states()) {
        let p = scenario.params;
        for law in [OracleLaw::Neural, OracleLaw::Plain] {
            scenario.law = law;
            let flow = Flow::new(&scenario);
            let mut state = State::zeros();
            state.fixed_rows_mut::<8>(0).copy_from_slice(&plant);
            state.fixed_rows_mut::<6>(8).copy_from_slice(&memory);
            state.fixed_rows_mut::<4>(8).scale_mut(p.b.min(p.d));
            for phase in [Phase::Tracking, Phase::Parking] {
                let at = |h: f64| command(&flow, phase, 1.0 + h, &flow.advance(phase, 1.0, 1.0 + h, &state, H)).0;
                let difference = (at(H) - at(-H)) / (2.0 * H);
                let (_, rate) = command(&flow, phase, 1.0, &state);
                let off = (difference - rate).amax() / rate.amax().max(1.0);
                prop_assert!(off <= COMMAND_RATE, "{law:?} {phase:?}: {difference} {rate}");
            }
        }
    }
}

/// How the largest torque change per tick shrinks from 2 ms to 1 ms.
fn shrinks<C: Controller<f64>>(scenario: &Scenario) -> Vector2<f64> {
    let [coarse, fine] = [2e-3, 1e-3].map(|dt| largest_torque_change(&run::<f64, C>(scenario, dt)));
    coarse.component_div(&fine)
}

/// Torque of Eq. (16) and Eq. (21) is Lipschitz: its change per tick halves with the tick. That of Eq. (12) jumps.
#[test]
fn torque_changes_halve_with_the_tick_but_for_plain_backstepping() {
    for scenario in [Scenario::paper_line(), Scenario::paper_curve()] {
        let neural = shrinks::<NeuralController<f64, Libm>>(&scenario);
        let plain = shrinks::<PlainController<f64, Libm>>(&scenario);
        println!(
            "neural {:.3} {:.3}, plain {:.3} {:.3}",
            neural.x, neural.y, plain.x, plain.y
        );
        for axis in 0..2 {
            assert_within(neural[axis], 2.0, HALVES, "neural");
            assert_within(plain[axis], 1.0, HALVES, "plain");
        }
    }
}
