//! `run`, `check` and `compile` of trajectory files and motion scenarios, from outside.

use crate::program::{program, sim_host};
use sim_host::csv_out::Columns;
use std::error::Error;
use std::fs;
use tests::fixtures;

fn fixture(name: &str) -> String {
    fixtures::path(name).display().to_string()
}

#[test]
fn a_file_is_run_with_figure_metrics_and_trace() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let file = fixture("wpilib_gaps.json");
    let output = sim_host(here.path(), &["run", &file, "--csv"]);
    let said = String::from_utf8(output.stdout)?;
    assert!(output.status.success(), "{said}");
    for part in [
        "format     WPILib",
        "repairs",
        "base       30 kg base",
        "tracking",
        "parked",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let out = here.path().join("out");
    let svg = fs::read_to_string(out.join("wpilib_gaps.svg"))?;
    assert!(svg.contains("hand-over") && svg.contains("Posture errors"));
    assert!(fs::read(out.join("wpilib_gaps.png"))?.starts_with(b"\x89PNG"));
    let json = fs::read_to_string(out.join("wpilib_gaps.json"))?;
    let records: serde_json::Value = serde_json::from_str(&json)?;
    let metrics = records.pointer("/0/metrics").ok_or("no metrics")?;
    assert_eq!(metrics.pointer("/outcome"), Some(&"parked".into()));
    let number = |at: &str| {
        metrics
            .pointer(at)
            .and_then(serde_json::Value::as_f64)
            .ok_or(at.to_owned())
    };
    assert!(number("/tracking/rms_m")? < 5e-3 && number("/tracking/peak_m")? < 2e-2);
    // It rests at its goal: followed through its end, and parked there.
    let late = number("/parked_s")? - number("/run/hand_over/time_s")?;
    assert!(late > 0.0 && late < 0.3, "{late}");
    assert!(number("/hand_over_distance_m")? < 1e-3);
    let mut trace = csv::Reader::from_path(out.join("wpilib_gaps.csv"))?;
    assert_eq!(trace.headers()?, Columns::Motion.names());
    let last = trace.records().last().ok_or("no rows")??;
    assert!(last.iter().any(|field| field == "parked"));
    Ok(())
}

#[test]
fn what_is_refused_says_where_and_why() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    for (name, reason) in [
        ("pathplanner.path", "field `waypoints`: a PathPlanner path"),
        ("pathweaver.path", "line 1: a PathWeaver path"),
        (
            "choreo_swerve.traj",
            "field `trajectory.sampleType`: samples of a swerve base",
        ),
        (
            "table_sideways.csv",
            // The first of steps that are all as far aside.
            "line 13, sample 11: no wheeled base passes here",
        ),
        (
            "tum_climbing.txt",
            "line 22, sample 21, field `z`: not planar",
        ),
    ] {
        let checked = sim_host(here.path(), &["check", &fixture(name)]);
        assert_eq!(checked.status.code(), Some(1), "{name}");
        let said = String::from_utf8(checked.stdout)?;
        assert!(
            said.contains("verdict    refused") && said.contains(reason),
            "{said}"
        );
        let run = sim_host(here.path(), &["run", &fixture(name)]);
        assert_eq!(run.status.code(), Some(1), "{name}");
        assert!(String::from_utf8(run.stderr)?.contains(reason), "{name}");
    }
    assert!(!here.path().join("out").exists());
    Ok(())
}

#[test]
fn check_says_what_is_drivable_without_running() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    for name in [
        "wpilib_dirty.json",
        "choreo_v1.traj",
        "tum_planar.txt",
        "table_bare.csv",
    ] {
        let output = sim_host(here.path(), &["check", &fixture(name)]);
        let said = String::from_utf8(output.stdout)?;
        assert!(
            output.status.success() && said.contains("verdict    drivable"),
            "{said}"
        );
        assert!(said.contains("base       30 kg base: "), "{said}");
    }
    // Scenarios of both laws as well.
    for (name, code) in [("paper-line", 0), ("park-beside", 0), ("no-such.toml", 1)] {
        assert_eq!(
            sim_host(here.path(), &["check", name]).status.code(),
            Some(code),
            "{name}"
        );
    }
    assert!(!here.path().join("out").exists());
    Ok(())
}

/// A file that is not there and one that is refused keep none after them from being judged.
#[test]
fn check_judges_every_file() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let files = [
        "no-such.csv",
        &fixture("pathweaver.path"),
        "park-beside",
        &fixture("table.csv"),
    ];
    let output = sim_host(here.path(), &[&["check"], files.as_slice()].concat());
    let (said, failed) = (
        String::from_utf8(output.stdout)?,
        String::from_utf8(output.stderr)?,
    );
    assert_eq!(output.status.code(), Some(1), "{said}{failed}");
    for (file, verdict) in files
        .into_iter()
        .zip(["refused", "refused", "in order", "drivable"])
    {
        let rest = said.split_once(&format!("{file}\n")).ok_or(file)?.1;
        let own = rest.split("\n\n").next().unwrap_or_default();
        assert!(
            own.contains(&format!("verdict    {verdict}")),
            "{file}: {said}"
        );
    }
    assert!(
        said.contains("no-such.csv: cannot be read: No such file"),
        "{said}"
    );
    assert!(failed.contains("2 of 4 files refused"), "{failed}");
    Ok(())
}

/// The base's own period, as its gains are for that one, unless another is asked for.
#[test]
fn a_file_is_run_at_the_period_of_its_base() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let file = fixture("small_table.csv");
    for (more, period_s) in [(&[][..], 0.005), (&["--period", "0.02"][..], 0.02)] {
        let arguments = [&["run", &file, "--csv", "--base", "hobby-1kg"], more].concat();
        assert!(sim_host(here.path(), &arguments).status.success());
        let mut trace = csv::Reader::from_path(here.path().join("out/small_table.csv"))?;
        let second = trace.records().nth(1).ok_or("no rows")??;
        let t: f64 = second.get(0).ok_or("no cells")?.parse()?;
        assert!((t - period_s).abs() < 1e-9, "{more:?}: {t}");
    }
    Ok(())
}

/// What a scenario has in its file is refused beside it, and taken where one of the files is a trajectory.
#[test]
fn options_of_trajectory_files_are_refused_with_scenarios() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    for option in [
        &["--base", "lab-10kg"][..],
        &["--offset", "0.3"],
        &["--fastest"],
        &["--tolerance", "0"],
        &["--precision", "f32"],
        &["--period", "0.01"],
    ] {
        let output = sim_host(here.path(), &[&["run", "park-beside"], option].concat());
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(1), "{option:?}");
        let expected = format!(
            "{} is for trajectory files: a scenario says it itself",
            option[0]
        );
        assert!(said.contains(&expected), "{said}");
    }
    let paper = ["compare", "paper-line", "--base", "lab-10kg"];
    assert!(!sim_host(here.path(), &paper).status.success());
    assert!(!here.path().join("out").exists());
    let by_base = [&paper[..], &["--law", "motion"]].concat();
    assert!(sim_host(here.path(), &by_base).status.success());
    let both = ["run", "park-beside", &fixture("table.csv"), "--offset", "0"];
    assert!(sim_host(here.path(), &both).status.success());
    Ok(())
}

/// Not when the runs are made that it would be of.
#[test]
fn the_name_of_a_log_is_checked_first() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    for command in [
        &["run", "park-beside"][..],
        &["faults", "--runs", "1"],
        &["verify", "hobby-1kg"],
        &["pil", "paper-line"],
        &["monitor", "no-such"],
        &["merge", "no-such"],
    ] {
        let output = sim_host(here.path(), &[command, &["--log", "f.txt"]].concat());
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(1), "{command:?}");
        assert!(said.contains("f.txt: the name of a log ends in"), "{said}");
        assert_eq!(String::from_utf8(output.stdout)?, "", "{command:?}");
    }
    assert!(!here.path().join("out").exists());
    Ok(())
}

#[test]
fn a_name_that_leads_to_nothing_is_told_what_is_built_in() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    for (arguments, is_name) in [
        (&["run", "park-besides"][..], true),
        (&["verify", "lab"], true),
        (&["check", "park-beside", "--base", "lab"], true),
        (&["run", "mine.csv"], false),
        (&["run", "here/mine"], false),
    ] {
        let said = String::from_utf8(sim_host(here.path(), arguments).stderr)?;
        assert!(said.contains("cannot be read: No such file"), "{said}");
        let told = said.contains("built in are the scenarios of `sim-host list` and the bases");
        assert_eq!(told, is_name, "{said}");
    }
    Ok(())
}

/// Files that are no scenarios keep none from being listed; a base that is not there is told where it is named.
#[test]
fn files_beside_scenarios_are_told_after_them() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let text =
        "[run]\nduration = 2.0\nperiod = 0.005\n[controller]\nkind = \"motion\"\n[goal]\nx = 0.1\n";
    for (name, text) in [
        ("a.toml", "[robot]\n".to_owned()),
        ("b.toml", format!("description = \"short\"\n{text}")),
        (
            "c.toml",
            format!("description = \"none\"\nbase = \"lab\"\n{text}"),
        ),
    ] {
        fs::write(here.path().join(name), text)?;
    }
    let output = sim_host(here.path(), &["list", "."]);
    let (said, failed) = (
        String::from_utf8(output.stdout)?,
        String::from_utf8(output.stderr)?,
    );
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(said, "b  short\n");
    for part in [
        "a.toml:1:",
        "c.toml:2: base: ",
        "lab: cannot be read: No such file",
    ] {
        assert!(failed.contains(part), "{part}: {failed}");
    }
    Ok(())
}

/// In scripts: a goal that is not reached and a base that stops are failures, an end on the way is none.
#[test]
fn exit_codes_tell_what_was_not_done() -> Result<(), Box<dyn Error>> {
    const RUN: &str = "[run]\nduration = 2.0\nperiod = 0.005\n[controller]\nkind = \"motion\"\n";
    const BASE: &str = "base = \"hobby-1kg\"\n";
    const GOAL: &str = "[goal]\nx = 0.3\n";
    const LINE: &str = "[reference]\nv = 0.2\n";
    let here = tempfile::tempdir()?;
    for (text, why) in [
        (format!("{RUN}[goal]\nx = 0.1\n"), None),
        (
            format!("{RUN}[goal]\nx = 5.0\n"),
            Some("mine: the robot did not park"),
        ),
        (
            format!("{RUN}{LINE}[[event]]\nat = 1.5\ngoal = {{ x = 5.0 }}\n"),
            Some("mine: the robot did not park"),
        ),
        (format!("{RUN}{LINE}"), None),
        // The goal is 3 s away.
        (format!("{RUN}{LINE}[hand_over]\ntarget_at = 3.0\n"), None),
        (
            format!("{RUN}[goal]\nx = 0.1\n[[event]]\nat = 1.0\ndrive = {{ v = 0.1 }}\n"),
            None,
        ),
        // No pose ever comes.
        (
            format!(
                "{BASE}{RUN}{GOAL}[world.pose_source]\nrate_hz = 20.0\ndrop_probability = 1.0\n"
            ),
            Some("mine: the base stopped at "),
        ),
    ] {
        fs::write(here.path().join("mine.toml"), &text)?;
        let output = sim_host(here.path(), &["run", "mine.toml"]);
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(
            output.status.code(),
            Some(i32::from(why.is_some())),
            "{text}{said}"
        );
        match why {
            Some(why) => assert!(said.starts_with(&format!("error: {why}")), "{text}{said}"),
            None => assert!(said.is_empty(), "{text}{said}"),
        }
        // Results are written either way.
        assert!(here.path().join("out/mine.json").exists(), "{text}");
    }
    Ok(())
}

/// Of several files every one that fails is named at the end, in their order, and does not keep the others from running.
#[test]
fn every_failure_is_told() -> Result<(), Box<dyn Error>> {
    const RUN: &str = "[run]\nduration = 1.0\nperiod = 0.005\n[controller]\nkind = \"motion\"\n";
    let here = tempfile::tempdir()?;
    for (name, x) in [("near", 0.05), ("far", 5.0), ("farther", 6.0)] {
        let text = format!("{RUN}[goal]\nx = {x}\n");
        fs::write(here.path().join(name).with_extension("toml"), text)?;
    }
    let output = sim_host(
        here.path(),
        &["run", "far.toml", "near.toml", "farther.toml"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        String::from_utf8(output.stderr)?,
        "error: far: the robot did not park\nerror: farther: the robot did not park\n"
    );
    for name in ["near", "far", "farther"] {
        assert!(here.path().join(format!("out/{name}.json")).exists());
    }
    // What cannot be used is told before anything runs.
    fs::write(here.path().join("bad.toml"), "[run]\nspan = 1.0\n")?;
    let arguments = &["run", "no.toml", "far.toml", "bad.toml", "--out", "none"];
    let output = sim_host(here.path(), arguments);
    let said = String::from_utf8(output.stderr)?;
    let told: Vec<_> = said.lines().filter(|l| l.starts_with("error")).collect();
    assert!(
        told.len() == 2 && told[0].contains("no.toml") && told[1].contains("bad.toml:2: run.span"),
        "{said}"
    );
    assert!(!here.path().join("none").exists());
    Ok(())
}

/// What comes from a pipe can be read only once.
#[cfg(unix)]
#[test]
fn a_pipe_is_a_file() -> Result<(), Box<dyn Error>> {
    use std::io::Write as _;
    use std::process::Stdio;
    let mut child = program()
        .args(["check", "/dev/stdin"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let text = fs::read(fixture("table_bare.csv"))?;
    child.stdin.take().ok_or("a pipe")?.write_all(&text)?;
    let said = String::from_utf8(child.wait_with_output()?.stdout)?;
    assert!(said.contains("verdict    drivable"), "{said}");
    Ok(())
}

/// Results are named after the file, so two of one name are refused by their paths.
#[test]
fn two_files_of_one_name_are_refused_as_what_they_are() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    for folder in ["a", "b"] {
        fs::create_dir(here.path().join(folder))?;
        fs::copy(
            fixture("table_bare.csv"),
            here.path().join(folder).join("x.csv"),
        )?;
    }
    for command in ["run", "compile"] {
        let output = sim_host(here.path(), &[command, "a/x.csv", "b/x.csv"]);
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(
            String::from_utf8(output.stderr)?,
            "error: a/x.csv and b/x.csv: both are named x, so their results would overwrite each other\n"
        );
        assert!(!here.path().join("out").exists(), "{command}");
    }
    Ok(())
}

#[test]
fn the_content_tells_a_scenario_from_a_trajectory() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    fs::copy(fixture("table.csv"), here.path().join("a.toml"))?;
    fs::write(here.path().join("b.json"), "# mine\n\n[run]\nduration = \n")?;
    fs::write(here.path().join("c.toml"), "")?;
    let checked = sim_host(here.path(), &["check", "a.toml"]);
    assert!(String::from_utf8(checked.stdout)?.contains("format     CSV"));
    let run = sim_host(here.path(), &["run", "b.json"]);
    assert!(String::from_utf8(run.stderr)?.starts_with("error: b.json:4"));
    let run = sim_host(here.path(), &["run", "c.toml"]);
    assert!(String::from_utf8(run.stderr)?.starts_with("error: c.toml:1: run: is missing"));
    // Of brackets alone nothing is TOML.
    let deep = here.path().join("deep.json");
    fs::write(&deep, "[".repeat(200_000))?;
    let output = sim_host(here.path(), &["run", "deep.json"]);
    let said = String::from_utf8(output.stderr)?;
    assert!(said.contains("EOF while parsing a list"), "{said}");
    Ok(())
}

#[test]
fn files_are_compiled_for_a_chip() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let output = sim_host(here.path(), &["compile", &fixture("choreo_v1.traj")]);
    assert!(output.status.success());
    let rust = fs::read_to_string(here.path().join("out/choreo_v1.rs"))?;
    assert!(rust.contains("pub static CHOREO_V1: [[f32; 9];") && rust.contains("within 0."));
    assert_eq!(
        fs::read(here.path().join("out/choreo_v1.bin"))?.len() % 36,
        0
    );
    let output = sim_host(here.path(), &["compile", "paper-line"]);
    assert_eq!(output.status.code(), Some(1));
    Ok(())
}

/// A base that brakes harder than it accelerates, and reverses: the jerk limit lets the one go over into the other.
#[test]
fn a_peak_beyond_its_limit_is_explained() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let text = "\
base = \"lab-10kg\"
[run]
duration = 3.0
period = 0.01
[controller]
kind = \"motion\"
[[event]]
at = 0.0
drive = { v = 1.0 }
[[event]]
at = 1.5
drive = { v = -1.0 }
";
    fs::write(here.path().join("reverses.toml"), text)?;
    let said = String::from_utf8(sim_host(here.path(), &["run", "reverses.toml"]).stdout)?;
    let peaks = said.lines().find(|line| line.starts_with("peaks"));
    let peaks = peaks.ok_or("no peaks")?;
    for part in [
        "peaks      of their limits: commanded speed 1 of 1.2 m/s, ",
        "acceleration 1.5 of 1 m/s2 (beyond it for some ticks: ",
        "braking 1.5 of 1.5 m/s2, ",
    ] {
        assert!(peaks.contains(part), "{peaks}");
    }
    assert_eq!(peaks.matches("beyond").count(), 1, "{peaks}");
    Ok(())
}
