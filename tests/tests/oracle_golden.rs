//! The oracle against the recorded closed loops: two independent implementations of the paper agree.

use tests::golden::{Golden, Kind, largest_difference};
use tests::oracle::{OracleRow, continuous, sampled};
use tests::tolerance::{GOLDEN_CONTINUOUS, GOLDEN_SAMPLED, REFERENCE_POSTURE};

const NAMES: [&str; 4] = ["case1", "case2", "plain_case2", "sampled_case1_10ms"];

/// Panics with row and column where the traces differ by more than `tolerance`.
fn assert_same(name: &str, golden: &[[f64; 20]], rows: &[OracleRow], tolerance: f64) {
    assert_eq!(rows.len(), golden.len(), "{name}: number of rows");
    let mut worst = (0.0, "t", 0.0);
    for (expected, row) in golden.iter().zip(rows) {
        let (difference, column) = largest_difference(&row.columns(), expected);
        if difference > worst.0 {
            worst = (difference, column, row.t);
        }
    }
    let (difference, column, t) = worst;
    println!("{name}: largest difference {difference:.2e} in {column} at {t} s");
    assert!(
        difference <= tolerance,
        "{name}: {difference:e} in {column} at {t} s, tolerance {tolerance:e}"
    );
}

fn assert_continuous_trace(name: &str) {
    let golden = Golden::read(name);
    assert_eq!(golden.kind, Kind::Continuous);
    let trace = continuous::run(&golden.scenario(), &golden.times(), continuous::STEP);
    assert_same(name, &golden.rows, &trace.rows, GOLDEN_CONTINUOUS);
    let (before, after) = trace.switch.expect("the trace has a switch");
    let recorded = [golden.switch_pre, golden.switch_post].map(|row| row.expect("recorded switch"));
    assert_same(name, &recorded, &[before, after], GOLDEN_CONTINUOUS);
}

/// Eq. (1) to Eq. (9), Eq. (15) to Eq. (23) on the paper's straight line.
#[test]
fn continuous_neural_line_matches_every_row_and_column() {
    assert_continuous_trace("case1");
}

/// Eq. (1) to Eq. (9), Eq. (15) to Eq. (23) on the paper's curve.
#[test]
fn continuous_neural_curve_matches_every_row_and_column() {
    assert_continuous_trace("case2");
}

/// Eq. (10) to Eq. (14) on the paper's curve, with k_c different from k_d.
#[test]
fn continuous_plain_curve_matches_every_row_and_column() {
    assert_continuous_trace("plain_case2");
}

/// Exact held solution of Eq. (4) in the loop of Eq. (15) to Eq. (23), sampled at 10 ms.
#[test]
fn sampled_neural_line_matches_every_row_and_column() {
    let name = "sampled_case1_10ms";
    let golden = Golden::read(name);
    assert_eq!(golden.kind, Kind::Sampled);
    let dt = golden.dt.expect("a sampled trace has a sample time");
    let trace = sampled::run(&golden.scenario(), dt);
    let rows: Vec<OracleRow> = golden
        .times()
        .iter()
        .map(|t| trace.rows[(t / dt).round() as usize])
        .collect();
    assert_same(name, &golden.rows, &rows, GOLDEN_SAMPLED);
    let (before, after) = trace.switch.expect("the trace has a switch");
    let recorded = [golden.switch_pre, golden.switch_post].map(|row| row.expect("recorded switch"));
    assert_same(name, &recorded, &[before, after], GOLDEN_SAMPLED);
}

/// Eq. (6): the recorded targets are the reference postures at N.
#[test]
fn recorded_targets_are_the_reference_at_its_end() {
    for name in NAMES {
        let golden = Golden::read(name);
        let posture = golden.reference.posture(golden.target_at);
        for (found, expected) in posture.iter().zip(golden.target) {
            assert!(
                (found - expected).abs() <= REFERENCE_POSTURE,
                "{name}: {found} instead of {expected}"
            );
        }
    }
}

/// Eq. (18) and Eq. (19): command and torque start from zero.
#[test]
fn neural_runs_start_without_command_or_torque() {
    for name in ["case1", "case2"] {
        let scenario = Golden::read(name).scenario();
        let start = continuous::run(&scenario, &[0.0], continuous::STEP).rows[0];
        assert!(start.command.velocity.norm() <= tests::tolerance::ALGEBRA);
        assert!(start.tau.norm() <= tests::tolerance::ALGEBRA);
    }
}
