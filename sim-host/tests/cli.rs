//! The program from outside, in an empty directory.

use crate::program::sim_host;
use sim_host::advice::of_base;
use sim_host::mission::Drivers;
use sim_host::verify::likely_causes;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::fixtures::path;
use tests::stated::{Stated, picture};

fn directory() -> TempDir {
    tempfile::tempdir().expect("a directory")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn succeeds(directory: &Path, arguments: &[&str]) -> String {
    let output = sim_host(directory, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

fn files(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).expect("a directory");
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names: Vec<_> = entries
        .map(|entry| name(entry.expect("an entry")))
        .collect();
    names.sort();
    names
}

/// A short scenario of the user's own.
const MINE: &str = "\
description = \"mine\"
[run]
duration = 1.0
period = 0.01
[controller]
parking = \"paper\"
[reference]
v = 0.4
[hand_over]
time = 0.505
target_at = 0.8
";

/// One that names its base.
const BY_NAME: &str = "\
base = \"hobby-1kg\"
[run]
duration = 1.0
period = 0.01
[controller]
kind = \"motion\"
[goal]
x = 0.1
";

fn gaps() -> String {
    path("wpilib_gaps.json").display().to_string()
}

/// The pictures of README and pages, which name these commands.
#[test]
fn the_documents_show_what_the_program_draws() {
    let gaps: &str = &gaps();
    for (arguments, drawn, shown) in [
        (&["run", gaps][..], "wpilib_gaps.png", "trajectory.png"),
        (&[], "paper-curve.png", "paper-curve.png"),
        (&["robustness"], "robustness.png", "robustness.png"),
    ] {
        let here = directory();
        succeeds(here.path(), &[arguments, &["--out", "out"]].concat());
        let drawn = fs::read(here.path().join("out").join(drawn)).expect("drawn");
        picture(&format!("docs/images/{shown}"), &drawn);
    }
}

#[test]
fn without_a_command_both_cases_of_the_paper_are_run() {
    let here = directory();
    let shown = succeeds(here.path(), &["--every", "100"]);
    for part in [
        "paper-line",
        "paper-curve",
        "settling time",
        "plain : neural",
        "4.98",
        "5.2",
    ] {
        assert!(shown.contains(part), "{part} is not in\n{shown}");
    }
    let mut expected = Vec::new();
    for case in ["paper-curve", "paper-line"] {
        for end in ["-neural.csv", "-plain.csv", ".json", ".png", ".svg"] {
            expected.push(format!("{case}{end}"));
        }
    }
    let out = here.path().join("out");
    assert_eq!(files(&out), expected);

    let json = fs::read_to_string(out.join("paper-line.json")).expect("metrics");
    let records: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(records[0]["controller"]["kind"], "neural");
    assert_eq!(records[1]["controller"]["kind"], "plain");
    let settling = records[0]["metrics"]["settling_s"]
        .as_f64()
        .expect("a time");
    assert!((settling - 4.98).abs() < 0.02, "{settling}");

    let svg = fs::read_to_string(out.join("paper-line.svg")).expect("a figure");
    for panel in [
        "(a)",
        "(b)",
        "(c)",
        "(d)",
        "(e)",
        "Posture errors",
        "hand-over 9 s",
    ] {
        assert!(svg.contains(panel), "{panel}");
    }
    let png = fs::read(out.join("paper-curve.png")).expect("a figure");
    assert!(png.starts_with(b"\x89PNG") && png.len() > 50_000);
}

/// What a legend names is drawn: a run that parks from the start has neither a reference nor a hand-over.
#[test]
fn legends_name_what_is_drawn() {
    let here = directory();
    let all = [
        "start",
        "reference",
        "hand-over",
        "goal given",
        "target",
        "ordered v",
        "ordered w",
    ];
    let figures = [
        ("park-beside", &["start", "target"][..]),
        ("standing-reference", &["start", "reference"]),
        ("reverse", &["start", "reference", "hand-over", "target"]),
        // Velocity orders are no path that there is to follow.
        (
            "drive-and-park",
            &["start", "goal given", "target", "ordered v", "ordered w"],
        ),
    ];
    let names = figures.map(|(name, _)| name);
    succeeds(here.path(), &[&["run"][..], &names].concat());
    for (name, drawn) in figures {
        let svg = here.path().join("out").join(format!("{name}.svg"));
        let svg = fs::read_to_string(svg).expect("a figure");
        let named = all.into_iter().filter(|e| svg.contains(&format!(">{e}<")));
        assert_eq!(named.collect::<Vec<_>>(), drawn, "{name}");
    }
}

/// Of a whole base, too, whose first ticks only wake it; and where, when and why it was stopped on its way is shown.
#[test]
fn figures_of_a_whole_base_show_its_goal_and_its_stop() {
    let here = directory();
    let park = "base = \"lab-10kg\"\n[run]\nduration = 8.0\nperiod = 0.01\n[controller]\nkind = \"motion\"\n[goal]\nx = 1.0\n[world.floor]\nmu = 0.9\n";
    // A battery of 24 V that has no more.
    let stops = format!("{park}[world.battery]\nnominal_v = 24.0\nopen_circuit_v = 15.0\n");
    for (name, text) in [("parks", park), ("stops", &stops)] {
        fs::write(here.path().join(format!("{name}.toml")), text).expect("written");
        let output = sim_host(here.path(), &["run", &format!("{name}.toml")]);
        let said = self::text(&output.stdout);
        assert!(!said.contains("moving reference"), "{said}");
        let svg = here.path().join("out").join(format!("{name}.svg"));
        let svg = fs::read_to_string(svg).expect("a figure");
        assert!(
            svg.contains(">target<") && !svg.contains("goal given"),
            "{name}"
        );
        let stopped = svg.matches(">stop, under voltage").count();
        // In the legend of the plane, and by the time in four panels.
        assert_eq!(stopped, if name == "stops" { 5 } else { 0 }, "{said}");
    }
}

#[test]
fn csv_files_hold_every_signal_in_full_precision() {
    let here = directory();
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    let out = here.path().join("results");
    succeeds(
        here.path(),
        &["run", "mine.toml", "--csv", "--out", "results"],
    );
    assert_eq!(
        files(&out),
        ["mine.csv", "mine.json", "mine.png", "mine.svg"]
    );

    let mut reader = csv::Reader::from_path(out.join("mine.csv")).expect("CSV");
    let header = reader.headers().expect("a header").clone();
    for column in [
        "t",
        "x",
        "y",
        "theta",
        "v",
        "w",
        "x_r",
        "y_r",
        "theta_r",
        "v_r",
        "w_r",
        "e_x",
        "e_y",
        "e_theta",
        "s1",
        "s2",
        "s3",
        "vdot_s",
        "wdot_s",
        "v_c",
        "w_c",
        "tau1",
        "tau2",
        "tau_right",
        "tau_left",
        "phase",
    ] {
        assert!(header.iter().any(|name| name == column), "{column}");
    }
    let rows: Vec<_> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 101);
    let column = |name: &str| header.iter().position(|other| other == name).expect(name);
    let trace = {
        let path = here.path().join("mine.toml");
        let scenario = sim_host::scenario::Scenario::load(&path).expect("in order");
        sim_host::run::run(&scenario).expect("no fault")
    };
    for (written, row) in rows.iter().zip(&trace.rows) {
        let read = |name: &str| written[column(name)].parse::<f64>().expect(name);
        assert_eq!(read("x").to_bits(), row.truth.pose.x.to_bits());
        assert_eq!(read("tau2").to_bits(), row.report.wrench.moment.to_bits());
        assert_eq!(
            read("s1").to_bits(),
            row.paper.expect("neurons").neurons.s1.to_bits()
        );
    }
    // 0.505 s: the first tick at or after it.
    assert_eq!(&rows[50][column("phase")], "tracking");
    assert_eq!(&rows[51][column("phase")], "parking");
    assert_eq!(&rows[51][column("handed_over")], "1");
}

#[test]
fn every_keeps_the_hand_over_and_the_last_row() {
    let here = directory();
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    succeeds(here.path(), &["run", "mine.toml", "--csv", "--every", "30"]);
    let mut reader = csv::Reader::from_path(here.path().join("out/mine.csv")).expect("CSV");
    let ticks: Vec<_> = reader
        .records()
        .map(|row| {
            row.expect("a row")
                .iter()
                .next_back()
                .expect("tick")
                .to_owned()
        })
        .collect();
    assert_eq!(ticks, ["0", "30", "51", "60", "90", "100"]);
}

#[test]
fn scenarios_are_compared_with_each_other_or_by_law() {
    let here = directory();
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    let shown = succeeds(here.path(), &["compare", "mine.toml"]);
    assert!(shown.contains("plain : neural"), "{shown}");
    let plain = MINE.replace("[controller]", "[controller]\nkind = \"plain\"");
    fs::write(here.path().join("rival.toml"), plain).expect("written");
    let shown = succeeds(
        here.path(),
        &["compare", "mine.toml", "rival.toml", "--out", "both"],
    );
    assert!(shown.contains("rival : mine"), "{shown}");
    let both = files(&here.path().join("both"));
    assert_eq!(
        both,
        [
            "mine-vs-rival.json",
            "mine-vs-rival.png",
            "mine-vs-rival.svg"
        ]
    );
}

/// The default law beside the paper's, on the same course; and what no other law can run is said.
#[test]
fn any_laws_are_compared() {
    let here = directory();
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    let arguments = [
        "compare",
        "mine.toml",
        "--law",
        "motion",
        "--law",
        "neural",
        "--csv",
    ];
    let shown = succeeds(here.path(), &arguments);
    assert!(shown.contains("neural : motion"), "{shown}");
    let records = fs::read_to_string(here.path().join("out/mine.json")).expect("metrics");
    let records: serde_json::Value = serde_json::from_str(&records).expect("JSON");
    assert_eq!(records[0]["controller"]["kind"], "motion");
    assert_eq!(records[1]["controller"]["kind"], "neural");
    let rows = |law| fs::read_to_string(here.path().join(format!("out/mine-{law}.csv")));
    let (motion, neural) = (rows("motion").expect("CSV"), rows("neural").expect("CSV"));
    assert_eq!(motion.lines().count(), neural.lines().count());
    assert!(motion != neural);
    // Several files, one of them of the default law.
    let shown = succeeds(
        here.path(),
        &["compare", "mine.toml", "park-beside", "--out", "both"],
    );
    assert!(shown.contains("park-beside : mine"), "{shown}");
    let refused = sim_host(here.path(), &["compare", "park-beside", "--law", "plain"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("is for the default law"));
}

#[test]
fn scenarios_are_listed_and_shown() {
    let here = directory();
    let listed = succeeds(here.path(), &["list"]);
    assert!(
        listed.contains("weaving") && listed.contains("Straight line of Fig. 3"),
        "{listed}"
    );
    let shown = succeeds(here.path(), &["show", "paper-line"]);
    fs::create_dir(here.path().join("own")).expect("made");
    fs::write(here.path().join("own/copy.toml"), &shown).expect("written");
    let listed = succeeds(here.path(), &["list", "own"]);
    assert!(listed.starts_with("copy  Straight line"), "{listed}");
    fs::create_dir(here.path().join("none")).expect("made");
    let output = sim_host(here.path(), &["list", "none"]);
    assert!(output.status.success() && output.stdout.is_empty());
    assert_eq!(
        text(&output.stderr),
        "note: none: has no scenarios (*.toml)\n"
    );
}

/// A file comes before what is built in, a directory does not: results of an earlier run may be in one.
#[test]
fn only_files_come_before_built_in_names() {
    let here = directory();
    for name in ["park-beside", "hobby-1kg"] {
        fs::create_dir(here.path().join(name)).expect("a directory");
    }
    let arguments = ["check", "park-beside", "--base", "hobby-1kg"];
    assert!(succeeds(here.path(), &arguments).contains("verdict    in order"));
    fs::write(here.path().join("mine.toml"), BY_NAME).expect("written");
    assert!(succeeds(here.path(), &["check", "mine.toml"]).contains("verdict    in order"));
    // A built-in robot is nobody's to write to, whatever else has its name.
    let refused = sim_host(here.path(), &["tune", "hobby-1kg", "--write"]);
    assert!(text(&refused.stderr).contains("hobby-1kg is built in"));
    for name in ["park-beside", "hobby-1kg"] {
        fs::remove_dir(here.path().join(name)).expect("empty");
        fs::write(here.path().join(name), "[nonsense]\n").expect("written");
    }
    for arguments in [
        &["run", "park-beside"][..],
        &["check", "mine.toml", "--base", "hobby-1kg"],
    ] {
        let refused = sim_host(here.path(), arguments);
        let said = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(1));
        assert!(said.contains(":1: nonsense: unknown field"), "{said}");
    }
}

/// A file of the law for a real base that does not say so is told that, and not that its base is no key.
#[test]
fn a_scenario_with_a_base_and_no_law_is_told_what_it_lacks() {
    let here = directory();
    for (from, to) in [("kind = ", "kid = "), ("kind = \"motion\"", "")] {
        assert!(BY_NAME.contains(from), "{from}");
        fs::write(here.path().join("typo.toml"), BY_NAME.replace(from, to)).expect("written");
        let refused = sim_host(here.path(), &["run", "typo.toml"]);
        let said = text(&refused.stderr);
        assert!(
            said.contains(": controller.kind: is missing: a file with a base"),
            "{said}"
        );
    }
}

/// A refusal repeats what was typed, which a terminal does not obey either.
#[test]
fn control_signs_of_arguments_are_written_out() {
    let here = directory();
    for (arguments, told) in [
        (&["\u{1b}[31mfoo"][..], r"'\u001B[31mfoo'"),
        (&["run", "a.toml", "--sp\u{9b}2Jeed"], r"'--sp\u009B2Jeed'"),
        (
            &["verify", "hobby-1kg", "--seeds", "\u{7}5"],
            r"invalid value '\u00075' for '--seeds <N>': must be a whole number",
        ),
    ] {
        let output = sim_host(here.path(), arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2));
        assert!(said.starts_with("error: ") && said.contains(told), "{said}");
        assert!(
            !said.contains(|c: char| c.is_control() && c != '\n'),
            "{said:?}"
        );
    }
}

/// A terminal obeys no file, and no name of one.
#[cfg(unix)]
#[test]
fn control_signs_of_files_are_written_out() {
    let here = directory();
    let wrong = "[run]\nduration = 1.0\nperiod = 0.01\n[reference]\nv = \"\u{9b}2J\"\n";
    fs::write(here.path().join("a\u{1b}[2Jb.toml"), wrong).expect("written");
    fs::write(here.path().join("c\u{7}.csv"), "t,x,y,the\u{1b}ta\n").expect("written");
    for command in ["run", "check"] {
        let output = sim_host(here.path(), &[command, "a\u{1b}[2Jb.toml", "c\u{7}.csv"]);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(1));
        for told in [
            r"a\u001B[2Jb.toml:5: reference.v: ",
            r#"5 | v = "\u009B2J""#,
            r"c\u0007.csv",
            r"the\u001Bta",
        ] {
            assert!(said.contains(told), "{told} is not in {said}");
        }
        assert!(
            !said.contains(|c: char| c.is_control() && c != '\n'),
            "{said:?}"
        );
    }
}

#[test]
fn warnings_go_to_standard_error() {
    let here = directory();
    let output = sim_host(here.path(), &["run", "weaving"]);
    assert!(output.status.success());
    let said = text(&output.stderr);
    assert!(
        said.starts_with("warning: weaving:") && said.contains("1.215"),
        "{said}"
    );
    assert!(!text(&output.stdout).contains("warning"));
}

/// Degrees are taken for radians, and that is said.
#[test]
fn headings_of_more_than_a_turn_are_warned_of() {
    let here = directory();
    let warned = |scenario: &str| {
        fs::write(here.path().join("turned.toml"), scenario).expect("written");
        text(&sim_host(here.path(), &["run", "turned.toml"]).stderr)
    };
    let rad = "is more than a turn: headings are in rad, and";
    for (scenario, key) in [
        (format!("{BY_NAME}theta = 90\n"), "goal.theta"),
        (format!("{BY_NAME}[start]\ntheta = -90\n"), "start.theta"),
        (
            format!("{BY_NAME}[[event]]\nat = 0.5\ngoal = {{ x = 0.1, y = 0.0, theta = 90 }}\n"),
            "event.goal.theta",
        ),
        (format!("{MINE}[start]\ntheta = 90\n"), "start.theta"),
        (
            MINE.replace(
                "target_at = 0.8",
                "target = { x = 0.4, y = 0.0, theta = 90 }",
            ),
            "hand_over.target.theta",
        ),
    ] {
        let said = warned(&scenario);
        assert!(
            said.contains(&format!("warning: turned: {key} = ")),
            "{said}"
        );
        assert!(
            said.contains(rad) && said.contains("90° are ") && said.contains("1.5708 rad"),
            "{said}"
        );
    }
    // A goal on a reference that has turned more than once is nobody's mistake.
    let winds = MINE.replace("v = 0.4", "v = 0.4\nw = 20.0");
    for scenario in [&format!("{BY_NAME}theta = 6.28\n"), &winds] {
        let said = warned(scenario);
        assert!(!said.contains(rad), "{said}");
    }
}

/// What is odd about a base and what to change in its file is said by whatever takes it, however it is named; of a scenario by whatever takes that.
#[test]
fn the_same_is_said_whatever_takes_a_file() {
    let here = directory();
    let base = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    let odd = base.replace("static_nm = 0.06", "static_nm = 0.81");
    let odd = odd.replace("longitudinal = ", "along = ");
    fs::write(here.path().join("odd.toml"), odd).expect("written");
    let by_name = BY_NAME.replace("hobby-1kg", "odd.toml");
    let by_name = format!("{by_name}theta = 90\n");
    fs::write(here.path().join("by.toml"), by_name).expect("written");
    let gaps: &str = &gaps();
    let of_base = [
        "note: odd.toml: `gains.along` is `gains.longitudinal` now; the old name is read for one release more",
        "warning: 1 kg hobby base: friction.static_nm = 0.81 N m is not less than the 0.803 N m that a motor gives at rest: the base does not move",
    ];
    let of_scenario = "warning: by: goal.theta = 90 is more than a turn: headings are in rad, and 90° are 1.5708 rad";
    for (arguments, scenario) in [
        (&["constants", "odd.toml"][..], None),
        (&["check", gaps, "--base", "odd.toml"], None),
        (&["compile", gaps, "--base", "odd.toml"], None),
        (&["run", gaps, "--base", "odd.toml"], None),
        (&["check", "by.toml"], Some(of_scenario)),
        (&["run", "by.toml"], Some(of_scenario)),
        (&["compare", "by.toml"], Some(of_scenario)),
    ] {
        let said = text(&sim_host(here.path(), arguments).stderr);
        let lines = said.lines().filter(|line| !line.starts_with("error: "));
        let expected: Vec<_> = of_base.into_iter().chain(scenario).collect();
        assert_eq!(lines.collect::<Vec<_>>(), expected, "{arguments:?}");
    }
}

#[test]
fn a_bad_file_is_an_error_with_file_line_and_key() {
    let here = directory();
    let bad = format!("{MINE}[gains]\nk2 = -1.0\n");
    fs::write(here.path().join("bad.toml"), bad).expect("written");
    let output = sim_host(here.path(), &["run", "bad.toml"]);
    assert_eq!(output.status.code(), Some(1));
    let said = text(&output.stderr);
    assert!(said.starts_with("error: bad.toml:13: gains.k2: "), "{said}");
    assert!(output.stdout.is_empty() && !here.path().join("out").exists());
    // A scenario's file is told what it is for, and so is a robot's.
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    for arguments in [
        &["run", &gaps(), "--base", "mine.toml"][..],
        &["verify", "mine.toml"],
    ] {
        let said = text(&sim_host(here.path(), arguments).stderr);
        let told = "error: mine.toml:2: run: is a scenario's, not a robot's: `run` takes it\n";
        assert!(said.starts_with(told), "{said}");
    }
    let base = tests::root().join("bases/hobby-1kg.toml");
    let output = sim_host(here.path(), &["run", &base.display().to_string()]);
    let said = text(&output.stderr);
    assert!(
        said.contains(
            "hobby-1kg.toml:10: limits: is a robot's, not a scenario's: `--base` takes it"
        ),
        "{said}"
    );
}

/// What no machine has the memory for is refused before anything runs, and numbers below 0 as numbers.
#[test]
fn numbers_have_limits() {
    let here = directory();
    for (arguments, code, told) in [
        (
            &["faults", "--runs", "100000001"][..],
            1,
            "error: runs must be at most 100000000",
        ),
        (
            &["faults", "--run", "18446744073709551615"],
            1,
            "error: the number of the first run must be at most 4503599627370496",
        ),
        (
            &["run", "paper-line", "--every", "-1"],
            2,
            "invalid value '-1' for '--every <N>'",
        ),
        (
            &["identify", "drive.csv", "--latency", "-0.1"],
            2,
            "invalid value '-0.1' for '--latency <S>': must be a number, not negative",
        ),
        (
            &["tune", "hobby-1kg", "--evaluations", "1000001"],
            2,
            "must be a whole number in 1 to 1000000",
        ),
        (
            &["verify", "hobby-1kg", "--seeds", "4294967295"],
            2,
            "invalid value '4294967295' for '--seeds <N>': must be a whole number in 1 to 100000",
        ),
        (
            &["robustness", "--seeds", "100001"],
            2,
            "must be a whole number in 1 to 100000",
        ),
    ] {
        let output = sim_host(here.path(), arguments);
        let said = text(&output.stderr);
        assert!(
            output.status.code() == Some(code) && said.contains(told),
            "{said}"
        );
    }
}

#[test]
fn exit_codes_tell_wrong_usage_from_failure() {
    let here = directory();
    let code = |arguments: &[&str]| sim_host(here.path(), arguments).status.code();
    assert_eq!(code(&["run"]), Some(2));
    assert_eq!(code(&["fly"]), Some(2));
    assert_eq!(code(&["--every", "0"]), Some(2));
    assert_eq!(code(&["run", "no-such.toml"]), Some(1));
    assert_eq!(code(&["show", "no-such"]), Some(1));
    assert_eq!(code(&["list", "no-such"]), Some(1));
    // Two files of one name would write the same results.
    fs::create_dir(here.path().join("a")).expect("made");
    fs::write(here.path().join("a/mine.toml"), MINE).expect("written");
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    assert_eq!(code(&["run", "mine.toml", "a/mine.toml"]), Some(1));
    // A file where the directory should be.
    let output = sim_host(here.path(), &["run", "mine.toml", "--out", "mine.toml"]);
    assert_eq!(output.status.code(), Some(1));
    let said = text(&output.stderr);
    assert!(
        said.starts_with("error: mine.toml: is a file: --out takes a directory"),
        "{said}"
    );
    if cfg!(unix) {
        let output = sim_host(here.path(), &["run", "mine.toml", "--out", "/dev/null"]);
        let said = text(&output.stderr);
        assert!(
            said.starts_with("error: /dev/null: is a file: --out takes a directory"),
            "{said}"
        );
    }
}

/// No result goes over what the command reads, whatever it is named; that over older results does.
#[test]
fn what_is_read_is_not_written_over() {
    let here = directory();
    let gaps: &str = &gaps();
    let file = here.path().join("mine.json");
    fs::copy(gaps, &file).expect("copied");
    for arguments in [
        &["run", "mine.json", "--out", "."][..],
        &["run", "mine.json", "--out", "out", "--log", "mine.json"],
    ] {
        let output = sim_host(here.path(), arguments);
        assert_eq!(output.status.code(), Some(1));
        let said = text(&output.stderr);
        assert!(
            said.contains("mine.json") || said.contains(".mcap"),
            "{said}"
        );
        assert_eq!(
            fs::read(&file).expect("there"),
            fs::read(gaps).expect("there")
        );
    }
    for _ in 0..2 {
        succeeds(here.path(), &["run", "mine.json", "--out", "out"]);
    }
    // As a log too: another run of the same command goes over the old one.
    for _ in 0..2 {
        succeeds(here.path(), &["run", "mine.json", "--log", "a.mcap"]);
    }
    let itself = &["run", "a.mcap:/odom", "--log", "a.mcap"];
    let before = fs::read(here.path().join("a.mcap")).expect("there");
    let said = text(&sim_host(here.path(), itself).stderr);
    assert!(said.contains("a.mcap: is read by this command"), "{said}");
    assert_eq!(fs::read(here.path().join("a.mcap")).expect("there"), before);
}

/// Without poses, slip and friction nothing of a run says how a real base does, and it says so.
#[test]
fn a_run_on_the_ideal_plant_says_so() {
    let here = directory();
    let gaps: &str = &gaps();
    for (arguments, ideal) in [
        (&["run", gaps, "--base", "lab-10kg"][..], true),
        (&["run", "bad-floor-line"], false),
    ] {
        let said = succeeds(here.path(), arguments);
        assert_eq!(said.contains("plant      ideal: "), ideal, "{said}");
    }
}

/// Where a number of the file says why it fails, that number is named and no other.
#[test]
fn coarse_encoders_noisy_poses_and_soft_drivers_are_named_as_the_likely_cause() {
    let here = directory();
    let base = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    for (from, to, cause) in [
        // 2 pi 35 mm/48, over 140 mm.
        (
            "counts_per_turn = 2048.0",
            "counts_per_turn = 48.0",
            "[encoder] counts_per_turn = 48: one count is 4.6 mm of a wheel's way and turns the base by 32.7 mrad",
        ),
        // A filter of 0.8 rad/s leaves 0.139 of it at 20 Hz; four of these are the tolerance.
        (
            "noise_m = 0.005",
            "noise_m = 0.02",
            "[pose_source] noise_m = 0.02: the base takes any place within 11.1 mm for its goal, and the filter leaves 2.8 mm of noise in its pose",
        ),
        // 4 · 0.06² · 2 · 0.06/0.035.
        (
            "period_s = 0.005",
            "period_s = 0.005\n\n[speed_driver]\nlag_s = 0.06",
            "[speed_driver] lag_s = 0.06: so soft a loop breaks a wheel that 0.06 N m hold loose after 49.4 mm of its way",
        ),
        // Of 34 of 0.75 times 10.5 mN m/A by 12 V/2.15 Ohm.
        (
            "dead_band = 0.03",
            "dead_band = 0.4",
            "motor.dead_band = 0.4 takes 0.598 N m of a motor at rest, more than limits.wheel_torque = 0.15 N m: the base hardly parks; most of so wide a dead band is friction of the gear: state that as friction.static_nm, and see `identify`",
        ),
    ] {
        assert!(base.contains(from), "{from}");
        fs::write(here.path().join("odd.toml"), base.replacen(from, to, 1)).expect("written");
        let output = sim_host(here.path(), &["verify", "odd.toml", "--seeds", "1"]);
        assert_eq!(output.status.code(), Some(1));
        let said = text(&output.stdout);
        let causes = said
            .lines()
            .filter_map(|line| line.strip_prefix("likely     "));
        assert_eq!(causes.collect::<Vec<_>>(), [cause], "{said}");
    }
}

/// Of a campaign on a robot of one's own as of its verification: where a rule is broken.
#[test]
fn a_campaign_names_the_likely_cause_as_well() {
    let here = directory();
    let base = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    let soft = format!("{base}\n[speed_driver]\nlag_s = 0.15\n");
    for (robot, is_soft) in [(&soft, true), (&base, false)] {
        fs::write(here.path().join("mine.toml"), robot).expect("written");
        let run = ["faults", "mine.toml", "--runs", "150", "--seed", "1"];
        let output = sim_host(here.path(), &run);
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(i32::from(is_soft)), "{said}");
        let causes = said.lines().filter(|line| line.starts_with("likely "));
        let named: Vec<_> = causes.map(|line| line.contains("lag_s = 0.15")).collect();
        assert_eq!(named, [true].repeat(usize::from(is_soft)), "{said}");
    }
}

/// Bases with a dead band, what holds a wheel at rest and the torque's limit \[N m\], and how many of 360 runs of `verify` each fail: it is warned of
/// those of which more than one does.
#[test]
fn dead_bands_are_warned_of_that_keep_a_base_from_its_goal() {
    for (name, dead_band, static_nm, torque_nm, failing) in [
        ("hobby-1kg", 0.1, 0.06, 0.15, 0),
        ("hobby-1kg", 0.15, 0.06, 0.15, 16),
        ("hobby-1kg", 0.4, 0.06, 0.15, 193),
        ("lab-10kg", 0.07, 0.35, 2.0, 0),
        ("lab-10kg", 0.08, 0.35, 2.0, 3),
        ("lab-10kg", 0.08, 0.35, 3.0, 0),
        ("lab-10kg", 0.1, 0.6, 2.0, 6),
        ("lab-10kg", 0.17, 0.35, 2.0, 163),
        ("paper-30kg", 0.1, 0.75, 15.0, 0),
        ("paper-30kg", 0.12, 0.75, 15.0, 10),
        ("paper-30kg", 0.2, 0.75, 15.0, 155),
    ] {
        let built_in = sim_host::scenario::BuiltInBase::find(name).expect("built in");
        let mut base = built_in.base().expect("valid");
        base.limits.wheel_torque_nm = torque_nm;
        let hardware = base.hardware.as_mut().expect("hardware");
        let Drivers::Bridges(motor) = &mut hardware.drivers else {
            panic!("{name} has bridges");
        };
        motor.dead_band = dead_band;
        hardware.friction.static_nm = static_nm;
        let said: Vec<_> = of_base(&base).iter().map(ToString::to_string).collect();
        let warned = said.iter().any(|line| line.contains("motor.dead_band = "));
        assert_eq!(warned, failing > 1, "{name} {dead_band}: {said:?}");
    }
}

/// From 7.2 mm at 20 Hz on, five times what the filter leaves is more than the 5 mm that are asked; of shipped bases nothing is.
#[test]
fn noise_is_a_cause_from_where_tolerance_and_noise_are_more_than_is_asked() {
    for built_in in sim_host::scenario::BASES {
        let mut base = built_in.base().expect("valid");
        assert!(likely_causes(&base).is_empty(), "{}", built_in.name);
        for (noise_m, is_cause) in [(0.0071, false), (0.0073, true)] {
            let hardware = base.hardware.as_mut().expect("hardware");
            hardware.pose_source.as_mut().expect("poses").noise_m = noise_m;
            assert_eq!(
                likely_causes(&base).len(),
                usize::from(is_cause),
                "{noise_m}"
            );
        }
    }
}

/// A robot that no board takes is said to be one, where constants are written for boards.
#[test]
fn constants_of_a_robot_with_speed_drivers_say_that_no_board_takes_them() {
    let here = directory();
    let base = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    let speeds = format!("{base}\n[speed_driver]\nlag_s = 0.02\n");
    fs::write(here.path().join("speeds.toml"), speeds).expect("written");
    let told = "note: 1 kg hobby base: no board of boards/ takes a robot with [speed_driver]: they have PWM outputs for motors only\n";
    for (arguments, told) in [
        (&["constants", "speeds.toml"][..], told),
        (&["constants", "speeds.toml", "--c"], ""),
    ] {
        let output = sim_host(here.path(), arguments);
        assert!(output.status.success());
        assert_eq!(text(&output.stderr), told);
    }
}

/// `docs/your-robot.md` has the beginning of what `constants` writes.
#[test]
fn the_page_shows_the_constants() {
    let here = directory();
    let text = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    let text = text.replacen("1 kg hobby base", "my robot", 1);
    fs::write(here.path().join("robot.toml"), text).expect("written");
    succeeds(here.path(), &["constants", "robot.toml"]);
    let written = fs::read_to_string(here.path().join("out/robot.rs")).expect("constants");
    let from = written.find("/// Time between ticks").expect("the first");
    let (shown, _) = written[from..].split_once("wheels: ").expect("wheels");
    let shown = format!("{}// ...\n", shown);
    Stated::of("docs/your-robot.md").rust("4. Constants", &shown);
}

/// A robot's file in another encoding is refused with line and byte, as any other file is.
#[test]
fn a_robot_in_another_encoding_is_refused_with_its_line() {
    let here = directory();
    fs::write(here.path().join("odd.toml"), b"# mine\n# na\xefve\n").expect("written");
    let output = sim_host(here.path(), &["constants", "odd.toml"]);
    let said = text(&output.stderr);
    let told = "error: odd.toml:2: not text: byte 11 is not UTF-8";
    assert!(!output.status.success() && said.contains(told), "{said}");
}

/// A robot that cannot be is refused with its line; of one that hardly is meant so, what is odd is said. The shipped ones are neither.
#[test]
fn impossible_robots_are_refused_and_unlikely_ones_named() {
    let here = directory();
    let base = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    let with = |from: &str, to: &str| {
        assert!(base.contains(from), "{from}");
        fs::write(here.path().join("odd.toml"), base.replacen(from, to, 1)).expect("written");
        let output = sim_host(here.path(), &["constants", "odd.toml"]);
        (output.status.success(), text(&output.stderr))
    };
    for (from, to, told) in [
        (
            "\nm = 1.0",
            "\nm = 2300.0",
            "robot.m: 2300 kg is more than solid steel weighs",
        ),
        // Lengths in centimetres.
        (
            "\nr = 0.035\nl = 0.14",
            "\nr = 3.5\nl = 14.0",
            "robot.m: 1 kg is less than the air between its wheels weighs",
        ),
        // In kg cm².
        (
            "\nI = 0.005",
            "\nI = 40.0",
            "robot.I: 40 kg m² is more than its mass has",
        ),
        // In g cm², beyond which the core finds no gains; and in t m².
        (
            "\nI = 0.005",
            "\nI = 50000.0",
            "odd.toml:6: robot.I: 50000 kg m²",
        ),
        (
            "\nI = 0.005",
            "\nI = 5e-6",
            "odd.toml:6: robot.I: 5e-6 kg m² is less than its mass has as a column",
        ),
        // In mm: no whole base takes it.
        (
            "noise_m = 0.005",
            "noise_m = 5.0",
            "odd.toml:46: pose_source.noise_m: is too much",
        ),
        // In mm/s, and by the key's own name. Limits are said as a user writes them, without exponents or zeros that only fill up.
        (
            "\nspeed = 0.8",
            "\nspeed = 800.0",
            "limits.speed: is above its largest value 100",
        ),
        // 34 of 0.75 times 10.5 mN m/A by 3 A, less 0.04 N m.
        (
            "\nwheel_torque = 0.15",
            "\nwheel_torque = 0.8",
            "limits.wheel_torque: is more than the 0.763 N m that [motor] gives at its current limit, after friction",
        ),
    ] {
        let (done, said) = with(from, to);
        assert!(
            !done && said.contains("error: odd.toml:") && said.contains(told),
            "{said}"
        );
    }
    for (from, to, told) in [
        (
            "noise_m = 0.005",
            // The most that the shipped bases take: of more no gain follows, and the file is refused.
            "noise_m = 0.2",
            "pose_source.noise_m = 0.2: the base takes any place within ",
        ),
        (
            "noise_rad = 0.005",
            "noise_rad = 1.0",
            "pose_source.noise_rad = 1: the base takes any heading within ",
        ),
        (
            "\naccel = 1.5",
            "\naccel = 30.0",
            // Of 1.94 kg, with the rotors.
            "limits.accel = 30 takes 1.020 N m of each wheel",
        ),
        (
            "\nbrake = 1.5",
            "\nbrake = 25.0",
            "limits.brake = 25 is more than the 20 m/s² that rubber holds",
        ),
        // What the body alone takes: rotors take as much again.
        (
            "\nwheel_torque = 0.15",
            "\nwheel_torque = 0.045",
            "limits.accel = 1.5 takes 0.051 N m of each wheel",
        ),
        (
            "counts_per_turn = 2048.0",
            "counts_per_turn = 1.0",
            "encoder.counts_per_turn = 1: the base takes any place within ",
        ),
        // 2 pi 35 mm/44, over 140 mm.
        (
            "counts_per_turn = 2048.0",
            "counts_per_turn = 44.0",
            "[encoder] counts_per_turn = 44: one count is 5.0 mm of a wheel's way and turns the base by 35.7 mrad",
        ),
        (
            "static_nm = 0.06",
            "static_nm = 0.81",
            "friction.static_nm = 0.81 N m is not less than the 0.803 N m that a motor gives at rest: the base does not move",
        ),
        (
            "static_nm = 0.06",
            "static_nm = 0.16",
            "friction.static_nm = 0.16 N m is not less than limits.wheel_torque = 0.15 N m: wheels break loose",
        ),
    ] {
        let (done, said) = with(from, to);
        let line = format!("warning: 1 kg hobby base: {told}");
        assert!(done && said.contains(&line), "{said}");
    }
    for base in sim_host::scenario::BASES {
        let output = sim_host(here.path(), &["constants", base.name]);
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{}",
            text(&output.stderr)
        );
    }
}

/// Numbers that no file states are not written in silence.
#[test]
fn constants_of_a_robot_without_hardware_say_what_they_assume() {
    let here = directory();
    let text_of_file = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml"));
    let base = text_of_file.expect("a base");
    let end = base.find("[motor]").expect("motors");
    fs::write(here.path().join("bare.toml"), &base[..end]).expect("written");
    let output = sim_host(here.path(), &["constants", "bare.toml", "--c"]);
    assert!(output.status.success());
    assert_eq!(
        text(&output.stderr),
        "warning: 1 kg hobby base: states no hardware: encoders of 4096 counts a turn, a tick of 10 ms, no poses and drivers of torques are assumed\n"
    );
    let header = fs::read_to_string(here.path().join("out/bare.h")).expect("a header");
    assert!(header.contains("_COUNTS_PER_TURN 4096.0f\n"), "{header}");
}

/// Encoders alone bring no base to where `verify` asks it to be and `tune` wants it: that is said before anything runs.
#[test]
fn a_robot_without_poses_is_neither_tuned_nor_verified() {
    let here = directory();
    let text = fs::read_to_string(tests::root().join("bases/hobby-1kg.toml")).expect("a base");
    let from = text.find("[pose_source]").expect("poses");
    let rest = text[from + 1..].find("\n[").expect("a next table");
    let blind = format!("{}{}", &text[..from], &text[from + 1 + rest..]);
    let bare = &text[..text.find("[motor]").expect("motors")];
    for robot in [&blind, bare] {
        fs::write(here.path().join("blind.toml"), robot).expect("written");
        for (command, asked) in [
            ("verify", "a run has to end within 5 mm and 10 mrad"),
            ("tune", "a run gets points for how far"),
        ] {
            let output = sim_host(here.path(), &[command, "blind.toml"]);
            assert_eq!(output.status.code(), Some(1));
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(
                said.starts_with("error: blind.toml:1: pose_source: is missing: ")
                    && said.contains(asked)
                    && said.contains("`faults ROBOT.toml`"),
                "{said}"
            );
            assert!(output.stdout.is_empty() && !here.path().join("out").exists());
        }
    }
    // What is advised is so: these keys suffice, and faults need none of them.
    fs::write(here.path().join("blind.toml"), &blind).expect("written");
    succeeds(here.path(), &["faults", "blind.toml", "--runs", "3"]);
    let keys = "rate_hz = 20.0\nlatency_s = 0.02\nnoise_m = 0.005\nnoise_rad = 0.005\n";
    let seeing = format!("{blind}\n[pose_source]\n{keys}");
    fs::write(here.path().join("seeing.toml"), seeing).expect("written");
    succeeds(here.path(), &["verify", "seeing.toml", "--seeds", "1"]);
}
