//! The core against the recorded closed loops: sampled in every tick, continuous by its own rates, and the one
//! converging to the other.

use controller_core::maths::Libm;
use controller_core::paper::neural::NeuralController;
use controller_core::shunting::{ExactHeld, ExactMean, RationalMean};
use nalgebra::Vector2;
use tests::core_flow::Flow;
use tests::core_loop::{Controller, Exact, Tick, hand_over, run};
use tests::golden::{Golden, Kind, largest_difference};
use tests::oracle::sampled::SWITCH_SLACK;
use tests::oracle::{OracleLaw, OracleRow, Phase, Scenario, continuous};
use tests::stated::{At, Stated};
use tests::tolerance::{
    CORE_CONTINUOUS, FIRST_ORDER_HIGH, FIRST_ORDER_LOW, GOLDEN_SAMPLED, MEAN_BEATS_HELD,
};

/// Controller of record with a given neuron update.
type Neural<U> = NeuralController<f64, Libm, U>;

/// Panics with row and column where the traces differ by more than `tolerance`; returns the largest difference.
fn assert_same(name: &str, golden: &[[f64; 20]], found: &[[f64; 20]], tolerance: f64) {
    assert_eq!(found.len(), golden.len(), "{name}: number of rows");
    let mut worst = (0.0, "t", 0.0);
    for (expected, row) in golden.iter().zip(found) {
        let (difference, column) = largest_difference(row, expected);
        if difference > worst.0 {
            worst = (difference, column, row[0]);
        }
    }
    let (difference, column, t) = worst;
    println!("{name}: largest difference {difference:.2e} in {column} at {t} s");
    assert!(
        difference <= tolerance,
        "{name}: {difference:e} in {column} at {t} s, tolerance {tolerance:e}"
    );
}

/// Eq. (4), Eq. (15) to Eq. (23) sampled: `ExactHeld` is the golden loop, tick by tick, through wheels and all.
#[test]
fn exact_held_reproduces_the_sampled_trace_in_every_row_and_column() {
    let golden = Golden::read("sampled_case1_10ms");
    assert_eq!(golden.kind, Kind::Sampled);
    let dt = golden.dt.expect("a sampled trace has a sample time");
    let ticks = run::<f64, Neural<ExactHeld>>(&golden.scenario(), dt);
    let rows: Vec<[f64; 20]> = golden
        .times()
        .iter()
        .map(|t| ticks[(t / dt).round() as usize].columns())
        .collect();
    assert_same(&golden.name, &golden.rows, &rows, GOLDEN_SAMPLED);
    let after = golden.switch_post.expect("recorded switch");
    let found = ticks[hand_over(&ticks)].columns();
    assert_same("after the hand-over", &[after], &[found], GOLDEN_SAMPLED);
}

/// Integrates the core's rates along a continuous golden trace and compares every row.
fn assert_continuous_trace(name: &str, law: OracleLaw) {
    let golden = Golden::read(name);
    assert_eq!((golden.kind, golden.controller), (Kind::Continuous, law));
    let scenario = golden.scenario();
    let switch = scenario.switch.expect("the trace has a switch");
    let flow = Flow::new(&scenario);
    let (mut phase, mut now, mut state) = (Phase::Tracking, 0.0, flow.start());
    let mut rows = Vec::with_capacity(golden.rows.len());
    for t in golden.times() {
        if t > now {
            state = flow.advance(phase, now, t, &state, continuous::STEP);
        } else if t == switch.at && phase == Phase::Tracking {
            // The second row of this instant.
            state = flow.switched(t, &state, &switch.target);
            phase = Phase::Parking;
        }
        now = t;
        rows.push(flow.columns(phase, t, &state));
    }
    assert_eq!(
        phase,
        Phase::Parking,
        "{name}: the trace has both rows at P"
    );
    assert_same(name, &golden.rows, &rows, CORE_CONTINUOUS);
}

/// Eq. (7) to Eq. (9), Eq. (15) to Eq. (23): the core's own rates on the straight line.
#[test]
fn continuous_rates_reproduce_the_neural_line_in_every_row_and_column() {
    assert_continuous_trace("case1", OracleLaw::Neural);
}

/// Eq. (7) to Eq. (9), Eq. (15) to Eq. (23): the core's own rates on the curve.
#[test]
fn continuous_rates_reproduce_the_neural_curve_in_every_row_and_column() {
    assert_continuous_trace("case2", OracleLaw::Neural);
}

/// Eq. (10) to Eq. (14): the core's backstepping on the curve.
#[test]
fn continuous_rates_reproduce_the_plain_curve_in_every_row_and_column() {
    assert_continuous_trace("plain_case2", OracleLaw::Plain);
}

/// Largest distance of the robot's posture (m and rad alike), and of its torques, to the continuous loop, at the instants of 10 ms.
fn distance<C: Controller<f64>>(scenario: &Scenario, rows: &[OracleRow], dt: f64) -> (f64, f64) {
    let ticks: Vec<Tick<f64>> = run::<f64, C>(scenario, dt);
    let stride = (10e-3 / dt).round() as usize;
    let mut largest = (0.0, 0.0);
    for (tick, row) in ticks.iter().step_by(stride).zip(rows) {
        assert!((tick.t - row.t).abs() < SWITCH_SLACK);
        largest.0 = f64::max(largest.0, (tick.body.q - row.q).norm());
        let torque: Vector2<f64> = tick.tau() - row.tau;
        largest.1 = f64::max(largest.1, torque.amax());
    }
    largest
}

/// The oracle's continuous loop every 10 ms, after the hand-over where it has two rows.
fn continuous_rows(scenario: &Scenario) -> Vec<OracleRow> {
    let times: Vec<f64> = (0..=2000).map(|k| f64::from(k) * 10e-3).collect();
    let mut rows = continuous::run(scenario, &times, continuous::STEP).rows;
    let at = scenario.switch.expect("a paper run has a switch").at;
    let before = rows.iter().position(|row| row.t == at);
    rows.remove(before.expect("the switch has rows"));
    rows
}

/// Distances at four ticks, and the order between each two.
fn assert_first_order<C: Controller<f64>>(
    name: &str,
    scenario: &Scenario,
    rows: &[OracleRow],
) -> [f64; 4] {
    let distances = [10e-3, 5e-3, 2.5e-3, 1.25e-3].map(|dt| distance::<C>(scenario, rows, dt));
    for (dt, (pose, torque)) in [10.0, 5.0, 2.5, 1.25].iter().zip(distances) {
        println!(
            "{name}, {dt} ms: {:.3} mm, {torque:.3} N or N m",
            1e3 * pose
        );
    }
    for pair in distances.windows(2) {
        let order = (pair[0].0 / pair[1].0).log2();
        println!("{name}: order {order:.3}");
        assert!(
            (FIRST_ORDER_LOW..=FIRST_ORDER_HIGH).contains(&order),
            "{name}: order {order}"
        );
    }
    distances.map(|(pose, _)| pose)
}

/// Eq. (15) to Eq. (23): a held torque is first order in the tick, whatever the neurons' update; the default update
/// is the closer one.
#[test]
fn sampled_runs_converge_to_the_continuous_loop_and_the_default_is_closer() {
    for (name, scenario) in [
        ("line", Scenario::paper_line()),
        ("curve", Scenario::paper_curve()),
    ] {
        let rows = continuous_rows(&scenario);
        let held = assert_first_order::<Neural<ExactHeld>>(
            &format!("{name}, exact held"),
            &scenario,
            &rows,
        );
        let mean = assert_first_order::<Neural<ExactMean>>(
            &format!("{name}, exact mean"),
            &scenario,
            &rows,
        );
        let rational = distance::<Neural<RationalMean>>(&scenario, &rows, 10e-3).0;
        let mut page = Stated::of("docs/derivation.md");
        if name == "curve" {
            let at_three_ticks = held[..3].iter().chain(&mean[..3]);
            page.exactly(
                At::Phrase("at h = 10 / 5 / 2.5 ms: held # / # / # mm, mean # / # / # mm"),
                &at_three_ticks.map(|pose| 1e3 * pose).collect::<Vec<_>>(),
            );
            page.exactly(
                At::Phrase("mm, # mm at 10 ms). The [0/4] form"),
                &[1e3 * rational],
            );
        } else {
            page.exactly(At::Phrase("as `ExactMean` (# mm,"), &[1e3 * rational]);
        }
        let (held, mean) = (held[0], mean[0]);
        println!(
            "{name}: held/mean {:.2}, rational {:.3} mm",
            held / mean,
            1e3 * rational
        );
        assert!(
            held >= MEAN_BEATS_HELD * mean,
            "{name}: {held} against {mean}"
        );
        assert!(
            held >= MEAN_BEATS_HELD * rational,
            "{name}: {held} against {rational}"
        );
        let default = distance::<Exact>(&scenario, &rows, 10e-3).0;
        assert_eq!(default, mean, "the default update is the mean one");
    }
}
