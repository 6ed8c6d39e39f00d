//! The program from outside: a log file in, a table, a JSON file and a robot's file out.

use crate::program::sim_host;
use crate::robot::{RECORDER, Robot, random, recommended};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Output;

fn csv() -> String {
    let mut random = random(5);
    let log = Robot::draw(&mut random).record(&RECORDER, &mut random, recommended);
    let step = log.step_rad.expect("counts");
    let mut text = String::from(
        "t,voltage_right,voltage_left,counts_right,counts_left,current_right,current_left,x,y,theta\n",
    );
    let current = log.current.expect("currents");
    let mut fixes = log.fixes.iter().peekable();
    for (row, i) in current.iter().enumerate() {
        let (u, a) = (log.command[row], log.angle[row]);
        let counts = a.map(|a| (a / step).round());
        let pose = match fixes.next_if(|fix| fix.row == row) {
            Some(fix) => format!("{},{},{}", fix.pose[0], fix.pose[1], fix.pose[2]),
            None => ",,".to_owned(),
        };
        let cells = [u[0], u[1], counts[0], counts[1], i[0], i[1]].map(|x| x.to_string());
        writeln!(text, "{:.3},{},{pose}", log.t[row], cells.join(",")).expect("a string");
    }
    text
}

#[test]
fn a_log_becomes_a_table_and_files() {
    let here = tempfile::tempdir().expect("a directory");
    fs::write(here.path().join("drive.csv"), csv()).expect("written");
    let mine = "# mine\n[robot]\nm = 1.0 # guessed\n";
    fs::write(here.path().join("robot.toml"), mine).expect("written");
    let run = |arguments: &[&str]| identify(here.path(), arguments);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    let turn = [
        "drive.csv",
        "--counts-per-turn",
        "2048",
        "--latency",
        "0.033",
    ];

    let output = run(&[
        &turn[..],
        &["--known", "gear=20", "--profile", "robot.toml"],
    ]
    .concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    for part in ["radius_right", "torque_constant_left", "±", "[motor]"] {
        assert!(shown.contains(part), "{part} in {shown}");
    }
    assert!(!shown.contains("not identifiable"), "{shown}");
    let json = fs::read_to_string(here.path().join("out/drive-identify.json")).expect("written");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json[0]["quantities"][0]["verdict"], "identified");
    let robot = fs::read_to_string(here.path().join("robot.toml")).expect("written");
    for part in [
        "# mine",
        "# guessed",
        "r_right = ",
        "kt_nm_per_a",
        "coulomb_nm",
    ] {
        assert!(robot.contains(part), "{part} in {robot}");
    }
    assert!(!robot.contains("\nm = 1.0"), "{robot}");
    // Without [limits] it is no base yet, which is said.
    assert!(shown.contains("not a whole base yet"), "{shown}");

    // Positions in mm: nothing is written.
    let in_mm: String = csv()
        .lines()
        .map(|line| {
            let mut cells: Vec<_> = line.split(',').map(str::to_owned).collect();
            for cell in &mut cells[7..9] {
                if let Ok(metres) = cell.parse::<f64>() {
                    *cell = (1.0e3 * metres).to_string();
                }
            }
            cells.join(",") + "\n"
        })
        .collect();
    fs::write(here.path().join("mm.csv"), in_mm).expect("written");
    let output = run(&[&["mm.csv"], &turn[1..], &["--profile", "robot.toml"]].concat());
    assert_eq!(output.status.code(), Some(1));
    let error = text(&output.stderr);
    assert!(
        error.contains("mm.csv: radius_right comes out as"),
        "{error}"
    );
    let kept = fs::read_to_string(here.path().join("robot.toml")).expect("written");
    assert_eq!(kept, robot);
    assert!(!here.path().join("out/mm-identify.json").exists());

    let output = run(&["drive.csv"]);
    assert_eq!(output.status.code(), Some(1));
    let error = text(&output.stderr);
    assert!(
        error.contains("drive.csv") && error.contains("--counts-per-turn"),
        "{error}"
    );
}

/// What comes of `identify` with these arguments.
pub fn identify(directory: &Path, arguments: &[&str]) -> Output {
    sim_host(directory, &[&["identify"], arguments].concat())
}

fn refusal(directory: &Path, arguments: &[&str]) -> String {
    let output = identify(directory, arguments);
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8(output.stderr).expect("UTF-8")
}

#[test]
fn a_statement_that_is_refused_says_so_once() {
    let here = tempfile::tempdir().expect("a directory");
    assert_eq!(
        refusal(here.path(), &["drive.csv", "--known", "mass=-1"]),
        "error: --known: mass=-1: must be finite and positive\n"
    );
}

/// In a second wheels may still look like ones that go against their commands, which was the reason then.
#[test]
fn a_short_log_is_refused_as_short() {
    let here = tempfile::tempdir().expect("a directory");
    let within = |line: &&str| {
        let time = line.split(',').next().and_then(|t| t.parse::<f64>().ok());
        time.is_none_or(|t| t <= 1.0)
    };
    let all = csv();
    let second: Vec<_> = all.lines().take_while(within).collect();
    fs::write(here.path().join("second.csv"), second.join("\n")).expect("written");
    let said = refusal(here.path(), &["second.csv", "--counts-per-turn", "2048"]);
    assert!(
        said.starts_with("error: second.csv: the log lasts 1 s, and at least 2 s are needed: "),
        "{said}"
    );
}

/// Seeds and rates are printed and written; the rest is `bases.rs`.
#[test]
fn coverage_names_its_seeds() {
    let here = tempfile::tempdir().expect("a directory");
    let base = concat!(env!("CARGO_MANIFEST_DIR"), "/../bases/paper-30kg.toml");
    let run = |base: &str| {
        let seed = ["--runs", "1", "--seed", "1200000000"];
        identify(here.path(), &[&["--coverage", base], &seed[..]].concat())
    };
    let output = run(base);
    // The same one is built in.
    assert_eq!(run("paper-30kg").stdout, output.stdout);
    let shown = String::from_utf8_lossy(&output.stdout);
    for part in ["1 drives, seeds 1200000000 to 1200000000", "mass", "1 of 1"] {
        assert!(shown.contains(part), "{part} in {shown}");
    }
    let json = here.path().join("out/paper-30kg-coverage.json");
    let json = fs::read_to_string(json).expect("written");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let rates = json[0]["rates"].as_array().expect("rates");
    assert_eq!(rates.len(), 21, "{shown}");
    // A single drive is no evidence against any interval.
    assert_eq!(output.status.code(), Some(0), "{shown}");
}
