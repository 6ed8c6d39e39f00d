//! Whole runs: the paper's figures, and what the scenario files promise.

use sim_host::advice::warnings;
use sim_host::metrics::Metrics;
use sim_host::run::run;
use sim_host::scenario::{BuiltIn, ControlLaw, Scenario};
use tests::stated::{At, Stated};

fn scenario(name: &str) -> Scenario {
    let built_in = BuiltIn::find(name).expect("built in");
    built_in.scenario().expect("in order")
}

/// A built-in scenario with a text replaced.
fn changed(name: &str, from: &str, to: &str) -> Scenario {
    let text = BuiltIn::find(name).expect("built in").text;
    assert!(text.contains(from), "{name} has no {from}");
    Scenario::parse("changed.toml", &text.replace(from, to)).expect("in order")
}

fn metrics(scenario: &Scenario) -> Metrics {
    Metrics::of(&run(scenario).expect("no fault")).expect("rows")
}

/// `value` within `tolerance` of `expected`.
fn near(value: f64, expected: f64, tolerance: f64) -> bool {
    (value - expected).abs() <= tolerance
}

#[test]
fn the_papers_errors_are_corrected_in_time() {
    for update in ["exact-held", "exact-mean", "rational-mean"] {
        for (name, expected) in [("paper-line", 4.98), ("paper-curve", 5.21)] {
            let metrics = metrics(&changed(name, "exact-mean", update));
            let settling = metrics.settling_s.expect("settles");
            // The figure of the continuous loop, rounded; sampling at 1 ms moves it by a few ms.
            assert!(
                near(settling, expected, 0.02),
                "{name}, {update}: {settling}"
            );
            assert!(
                metrics.final_error.position_m < 1.5e-3,
                "{name}: {metrics:?}"
            );
        }
    }
}

/// The table of `docs/paper.md`, as `cargo run --release` makes it.
#[test]
fn the_document_states_both_cases() {
    let all = ["paper-line", "paper-curve"].map(|name| {
        let scenario = scenario(name);
        [
            metrics(&scenario),
            metrics(&scenario.with_law(ControlLaw::Plain)),
        ]
    });
    let all: Vec<&Metrics> = all.iter().flatten().collect();
    let each = |of: fn(&Metrics) -> Vec<f64>| -> Vec<f64> {
        all.iter().flat_map(|metrics| of(metrics)).collect()
    };
    let mut page = Stated::of("docs/paper.md");
    let mut row = |label, measured: Vec<f64>| {
        let row = At::Row("What the paper's cases give", label);
        page.exactly(row, &measured);
    };
    row(
        "settled within 5 cm, 0.05 rad [s] (paper: about 5.0 and 5.2)",
        each(|m| vec![m.settling_s.expect("settles")]),
    );
    row(
        "final position error [mm]",
        each(|m| vec![1e3 * m.final_error.position_m]),
    );
    row(
        "peak force, moment [N, N m]",
        each(|m| vec![m.force_n.peak, m.moment_nm.peak]),
    );
    row(
        "largest change per tick [N, N m]",
        each(|m| {
            vec![
                m.force_n.largest_change_per_tick,
                m.moment_nm.largest_change_per_tick,
            ]
        }),
    );
    row(
        "step at the start [N, N m]",
        each(|m| vec![m.start_torque_step.force_n, m.start_torque_step.moment_nm]),
    );
    row(
        "step at the hand-over [N, N m]",
        each(|m| {
            let step = m.hand_over.expect("hands over").torque_step;
            vec![step.force_n, step.moment_nm]
        }),
    );
    let start = &all[3].start_torque_step;
    page.exactly(
        At::Phrase("plain law starts with # N and # N m from"),
        &[start.force_n, start.moment_nm],
    );
    page.exactly(
        At::Phrase("changes by at most # N and # N m a tick"),
        &[
            all[2].force_n.largest_change_per_tick,
            all[2].moment_nm.largest_change_per_tick,
        ],
    );
}

#[test]
fn the_papers_hand_over_is_a_pulse_without_a_jump() {
    let line = metrics(&scenario("paper-line"))
        .hand_over
        .expect("hands over");
    // An independent reference's figures, to their digits.
    assert!(near(line.error_after.e_x_m, 0.400, 1e-3), "{line:?}");
    assert!(
        near(line.parked_after_s.expect("parks"), 2.18, 0.01),
        "{line:?}"
    );
    let curve = metrics(&scenario("paper-curve"))
        .hand_over
        .expect("hands over");
    assert!(near(curve.error_after.e_x_m, 0.200, 1e-3), "{curve:?}");
    assert!(
        near(curve.error_after.e_theta_rad, 0.071, 1e-3),
        "{curve:?}"
    );
    assert!(
        near(curve.parked_after_s.expect("parks"), 0.86, 0.01),
        "{curve:?}"
    );
    for hand_over in [line, curve] {
        let step = hand_over.torque_step;
        assert!(
            step.force_n.abs() < 1e-9 && step.moment_nm.abs() < 1e-9,
            "{step:?}"
        );
        assert_eq!(hand_over.overshoot_m, 0.0);
    }
}

#[test]
fn a_switch_at_the_target_overshoots() {
    let late = changed("paper-curve", "time = 9.5", "time = 10.0");
    let hand_over = metrics(&late).hand_over.expect("hands over");
    // An independent reference: 11.0 cm.
    assert!(near(hand_over.overshoot_m, 0.110, 1e-3), "{hand_over:?}");
    Stated::of("docs/derivation.md").exactly(
        At::Phrase("overshoot and back up (# cm at P = N)"),
        &[1e2 * hand_over.overshoot_m],
    );
}

#[test]
fn plain_backstepping_steps_a_hundred_times_harder() {
    for (name, force, moment) in [("paper-line", 33.1, -63.8), ("paper-curve", 46.8, -164.3)] {
        let neural = metrics(&scenario(name));
        let plain = metrics(&scenario(name).with_law(ControlLaw::Plain));
        let start = plain.start_torque_step;
        assert!(near(start.force_n, force, 0.05) && near(start.moment_nm, moment, 0.05));
        for (plain, neural) in [
            (plain.force_n, neural.force_n),
            (plain.moment_nm, neural.moment_nm),
            (plain.torque_right_nm, neural.torque_right_nm),
            (plain.torque_left_nm, neural.torque_left_nm),
        ] {
            let ratio = plain.largest_change_per_tick / neural.largest_change_per_tick;
            assert!(ratio > 100.0, "{name}: {ratio}");
        }
    }
}

#[test]
fn a_run_gives_the_same_bits_twice() {
    let scenario = scenario("moving-start");
    assert_eq!(
        run(&scenario).expect("no fault"),
        run(&scenario).expect("no fault")
    );
}

#[test]
fn single_precision_stays_within_ten_micrometres() {
    for name in ["paper-line", "paper-curve"] {
        let double = run(&scenario(name)).expect("no fault");
        let single = run(&changed(name, "\"f64\"", "\"f32\"")).expect("no fault");
        for (a, b) in double.rows.iter().zip(&single.rows) {
            let (a, b) = (a.truth.pose, b.truth.pose);
            let apart = (a.x - b.x)
                .abs()
                .max((a.y - b.y).abs())
                .max((a.theta - b.theta).abs());
            assert!(apart < 1e-5, "{name}: {apart}");
        }
    }
}

#[test]
fn the_standing_reference_needs_a_transition_offset_and_starts_without_torque() {
    let metrics = metrics(&scenario("standing-reference"));
    assert!(
        metrics.bridged_ticks > 100 && metrics.settling_s.is_some(),
        "{metrics:?}"
    );
    let start = metrics.start_torque_step;
    assert!(
        start.force_n.abs() < 1e-12 && start.moment_nm.abs() < 1e-12,
        "{start:?}"
    );
}

#[test]
fn unequal_gains_do_not_jump_unless_printed() {
    let step = |scenario: &Scenario| metrics(scenario).hand_over.expect("hands over").torque_step;
    let continuous = step(&scenario("unequal-gains"));
    assert!(continuous.force_n.abs() < 1e-9 && continuous.moment_nm.abs() < 1e-9);
    let printed = step(&changed(
        "unequal-gains",
        "\"torque-continuous\"",
        "\"printed\"",
    ));
    // The figures that the file's comment gives.
    assert!(
        near(printed.force_n, -5.9, 0.05) && near(printed.moment_nm, 2.4, 0.05),
        "{printed:?}"
    );
    let left = metrics(&scenario("unequal-gains")).final_error.e_y_m;
    Stated::of("README.md").exactly(
        At::Phrase("its parking leaves lateral error (# cm in"),
        &[1e2 * left.abs()],
    );
}

#[test]
fn the_wrong_robot_saturates_and_parks() {
    let metrics = metrics(&scenario("wrong-robot"));
    assert!(metrics.saturated_ticks > 0 && metrics.torque_left_nm.peak <= 5.0);
    assert!(
        near(metrics.settling_s.expect("settles"), 5.5, 0.1),
        "{metrics:?}"
    );
    assert!(metrics.final_error.position_m < 3e-3, "{metrics:?}");
}

#[test]
fn weaving_is_warned_of_and_happens_and_can_be_cured() {
    let weaving = scenario("weaving");
    let said = warnings(&weaving);
    assert!(
        said.len() == 1 && said[0].contains("1.400") && said[0].contains("1.215"),
        "{said:?}"
    );
    assert_eq!(metrics(&weaving).settling_s, None);
    let cured = changed("weaving", "#[gains]\n#k2", "[gains]\nk2");
    assert!(warnings(&cured).is_empty());
    assert!(metrics(&cured).settling_s.is_some());
}

#[test]
fn hopeless_parking_gains_are_warned_of_only_if_they_are_used() {
    let hopeless = changed("paper-line", "k4 = 1.2 ", "k4 = 50.0 ");
    assert!(warnings(&hopeless).iter().any(|w| w.contains("parking")));
    assert!(warnings(&hopeless.with_law(ControlLaw::Plain)).is_empty());
    let mut tracking_only = hopeless;
    tracking_only.hand_over = None;
    assert!(warnings(&tracking_only).is_empty());
}
