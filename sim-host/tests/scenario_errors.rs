//! What a user gets to see for a file that cannot be used: file, line, key.

use sim_host::scenario::{BUILT_IN, MISSIONS, Scenario, ScenarioError};

/// A scenario that is in order, five lines long, and what is added to it from line 6 on.
fn error(more: &str) -> ScenarioError {
    let text = format!("[run]\nduration = 2.0\nperiod = 0.01\n[reference]\nv = 0.4\n{more}\n");
    Scenario::parse("mine.toml", &text).expect_err(more)
}

/// Key and line that the error of an addition names.
fn place(more: &str) -> (String, usize) {
    let error = error(more);
    let shown = error.to_string();
    assert!(shown.starts_with("mine.toml:"), "{shown}");
    assert!(shown.contains(&error.key), "{shown}");
    (error.key, error.line.expect("a line"))
}

fn at(key: &str, line: usize) -> (String, usize) {
    (key.to_owned(), line)
}

#[test]
fn unknown_keys_and_tables_are_refused() {
    assert_eq!(place("[gains]\nk1 = 1.0\nk9 = 1.0"), at("gains.k9", 8));
    assert_eq!(place("colour = 3"), at("reference.colour", 6));
    assert_eq!(place("[gain]\nk1 = 1.0"), at("gain", 6));
    assert_eq!(
        place("start = { x = 1, z = 2 }"),
        at("reference.start.z", 6)
    );
    assert_eq!(
        place("w = { w0 = 1, w1 = 2, Ov = 1 }"),
        at("reference.w.Ov", 6)
    );
}

#[test]
fn values_of_the_wrong_type_are_refused() {
    assert_eq!(place("[gains]\nk1 = \"fast\""), at("gains.k1", 7));
    assert_eq!(place("w = true"), at("reference.w", 6));
    assert_eq!(
        place("[controller]\nkind = \"magic\""),
        at("controller.kind", 7)
    );
    assert_eq!(
        place("[controller]\nparking = \"perfect\""),
        at("controller.parking", 7)
    );
    assert_eq!(place("w = { w1 = \"x\", Ow = 1 }"), at("reference.w.w1", 6));
}

#[test]
fn missing_keys_are_named() {
    let missing = |text: &str| Scenario::parse("m.toml", text).expect_err(text);
    let error = missing("[run]\nduration = 2.0\n[reference]\nv = 0.4\n");
    assert_eq!((error.key.as_str(), error.line), ("run.period", Some(1)));
    let error = missing("[run]\nduration = 2.0\nperiod = 0.1\n");
    assert_eq!(error.key, "reference");
    assert_eq!(place("w = { w0 = 1.0, w1 = 0.3 }"), at("reference.w.Ow", 6));
    assert_eq!(place("[hand_over]\ntime = 1.0"), at("hand_over", 6));
}

#[test]
fn ranges_of_the_core_are_reported_by_key() {
    let error = error("[gains]\nk2 = -3.0");
    assert_eq!(
        error.to_string(),
        "\
mine.toml:7: gains.k2: k2 is below its smallest value 1e-6
  |
7 | k2 = -3.0
  |      ^^^^"
    );
    assert_eq!(place("[gains]\nA = 0"), at("gains.A", 7));
    assert_eq!(place("[gains]\nkc2 = nan"), at("gains.kc2", 7));
    assert_eq!(place("[robot]\nm = 0.0"), at("robot.m", 7));
    assert_eq!(place("[robot]\nI = inf"), at("robot.I", 7));
    assert_eq!(place("[robot]\nr = 50"), at("robot.r", 7));
    assert_eq!(place("[robot]\nr_left = 50"), at("robot.r_left", 7));
    assert_eq!(place("[robot]\nl = 0"), at("robot.l", 7));
    assert_eq!(
        place("[robot]\nmax_wheel_torque = 0"),
        at("robot.max_wheel_torque", 7)
    );
    assert_eq!(
        place("[controller]\nmax_tick = -1"),
        at("controller.max_tick", 7)
    );
}

#[test]
fn a_law_that_there_is_not_is_refused_with_those_that_there_are() {
    let error = error("[controller]\nkind = \"moton\"");
    assert_eq!(
        (error.key.as_str(), error.line),
        ("controller.kind", Some(7))
    );
    assert!(
        error.to_string().contains("neural, plain and motion"),
        "{error}"
    );
}

#[test]
fn other_ranges_are_reported_by_key() {
    assert_eq!(
        place("[plant]\nmass_factor = 0"),
        at("plant.mass_factor", 7)
    );
    assert_eq!(place("[start]\ntheta = nan"), at("start.theta", 7));
    assert_eq!(place("w = -inf"), at("reference.w", 6));
    assert_eq!(place("w = { w1 = 1, Ow = 1e9 }"), at("reference.w.Ow", 6));
    assert_eq!(
        place("[hand_over]\ntime = 3\ntarget_at = 1"),
        at("hand_over.time", 7)
    );
    assert_eq!(
        place("[hand_over]\ntime = 0\ntarget_at = 1"),
        at("hand_over.time", 7)
    );
    assert_eq!(
        place("[hand_over]\ntime = 1\ntarget_at = -1"),
        at("hand_over.target_at", 8)
    );
    assert_eq!(
        place("[hand_over]\ntime = 1\ntarget = { x = inf }"),
        at("hand_over.target.x", 8)
    );
    let run = |duration: &str, period: &str| {
        let text = format!("[run]\nduration = {duration}\nperiod = {period}\n[reference]\nv = 1\n");
        let error = Scenario::parse("m.toml", &text).expect_err("a bad run");
        (error.key, error.line)
    };
    assert_eq!(run("1", "0"), ("run.period".to_owned(), Some(3)));
    assert_eq!(run("1", "nan"), ("run.period".to_owned(), Some(3)));
    assert_eq!(run("9", "0.6"), ("run.period".to_owned(), Some(3)));
    assert_eq!(run("0.1", "0.2"), ("run.duration".to_owned(), Some(2)));
    assert_eq!(run("inf", "0.2"), ("run.duration".to_owned(), Some(2)));
    assert_eq!(run("1e9", "0.001"), ("run.duration".to_owned(), Some(2)));
}

#[test]
fn contradictions_are_refused() {
    assert_eq!(
        place("[controller]\nmaths = \"micromath\""),
        at("controller.maths", 7)
    );
    let single = "[controller]\nprecision = \"f64\"\nmaths = \"single\"";
    assert_eq!(place(single), at("controller.maths", 8));
    assert_eq!(place("[robot]\nr_left = 0.1\nr = 0.1"), at("robot.r", 8));
    let targets = "[hand_over]\ntime = 1\ntarget = { x = 1 }\ntarget_at = 1";
    assert_eq!(place(targets), at("hand_over.target_at", 9));
}

#[test]
fn what_is_not_toml_is_refused_with_its_line() {
    assert_eq!(error("[gains").line, Some(6));
    assert_eq!(place("[gains]\nk1 = 1\nk1 = 2"), at("k1", 8));
    let missing = Scenario::load(std::path::Path::new("no-such-file.toml")).expect_err("no file");
    assert_eq!(
        (missing.file.as_str(), missing.line),
        ("no-such-file.toml", None)
    );
}

#[test]
fn every_built_in_scenario_is_in_order_and_described() {
    for built_in in BUILT_IN {
        let scenario = built_in
            .scenario()
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scenario.name, built_in.name);
        assert!(!scenario.description.is_empty(), "{}", built_in.name);
        // Later laws must not change what these files do.
        assert!(
            built_in.text.contains("parking = \"paper\""),
            "{}",
            built_in.name
        );
    }
}

#[test]
fn every_file_of_the_directory_is_built_in() {
    let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios");
    let files = std::fs::read_dir(directory).expect("the scenarios").count();
    assert_eq!(files, BUILT_IN.len() + MISSIONS.len());
}

#[test]
fn omitted_gains_are_the_papers() {
    let text = "[run]\nduration = 2\nperiod = 0.01\n[reference]\nv = 1\n";
    let scenario = Scenario::parse("plain.toml", text).expect("in order");
    assert_eq!(
        scenario.params,
        controller_core::paper::params::Params::paper()
    );
    assert_eq!(scenario.robot, scenario.params.robot);
    assert_eq!((scenario.hand_over, scenario.ticks()), (None, 200));
}
