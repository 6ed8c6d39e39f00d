//! Files: trajectories of every format, scenarios, bases.

use std::fs;

use sim_host::import::{self, Options};
use sim_host::mission::{BaseSpec, Mission};
use sim_host::scenario::Scenario;

use super::engine::{Met, Target};

/// All files of a folder of the workspace that are no longer than so many bytes.
fn folder(path: &str, longest: u64) -> Vec<Vec<u8>> {
    let path = crate::root().join(path);
    let mut files: Vec<_> = fs::read_dir(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|file| {
            file.metadata()
                .is_ok_and(|data| data.is_file() && data.len() <= longest)
        })
        .collect();
    files.sort();
    files
        .iter()
        .filter_map(|file| fs::read(file).ok())
        .collect()
}

/// The kind of a message: the first words of it that are not the input's.
fn kind_of(message: &str) -> String {
    let mut own = String::new();
    for (number, part) in message.split(['`', '"', '\'']).enumerate() {
        if number % 2 == 0 {
            own.push_str(part);
        }
    }
    let plain = |word: &&str| word.len() < 12 && word.bytes().all(|byte| byte.is_ascii_lowercase());
    let words: Vec<&str> = own
        .lines()
        .flat_map(str::split_whitespace)
        .filter(plain)
        .take(4)
        .collect();
    words.join(" ")
}

/// Trajectory files: what is read can be evaluated, and is finite.
pub const TRAJECTORY: Target = Target {
    name: "trajectory",
    run: trajectory,
    seeds: || folder("sim-host/tests/fixtures", 2_000),
    longest: 3_000,
    words: &[
        "t,x,y,theta\n",
        "time",
        "\"samples\":[",
        "\"pose\"",
        "\"translation\"",
        "\"rotation\"",
        "\"radians\"",
        "\"heading\"",
        "\"vl\"",
        "\"omega\"",
        "\"t\":",
        "\"x\":",
        "\"trajectory\"",
        "\"events\"",
        "{",
        "}",
        "[",
        "]",
        ",",
        "\n",
        "# ",
        "\u{FEFF}",
        "\"",
    ],
    in_a_test: 10_000,
};

fn trajectory(input: &[u8], met: &mut Met) {
    match import::import(input, &Options::default()) {
        Ok(trajectory) => {
            let end = trajectory.duration();
            assert!(end.is_finite() && end > 0.0);
            for k in 0..=20 {
                let sample = trajectory.at(end * f64::from(k) / 20.0);
                assert!(
                    [sample.x, sample.y, sample.theta, sample.v, sample.w]
                        .iter()
                        .all(|number| number.is_finite()),
                    "{sample:?}"
                );
            }
            met.saw(("read", trajectory.samples().len().min(64)));
        }
        Err(refusal) => met.saw((
            format!("{:?}", refusal.format),
            std::mem::discriminant(&refusal.reason),
        )),
    }
}

/// Scenario files, for either law: what is read can be run, and says how long it takes.
pub const SCENARIO: Target = Target {
    name: "scenario",
    run: scenario,
    seeds: || folder("scenarios", 8_000),
    longest: 6_000,
    words: &[
        "[run]\n",
        "duration = ",
        "period = ",
        "[goal]\n",
        "[start]\n",
        "[controller]\nkind = \"motion\"\n",
        "base = \"lab-10kg\"\n",
        "[[event]]\nat = 1.0\n",
        "drive = { v = 0.1 }\n",
        "[world]\n",
        "[robot]\n",
        "[limits]\n",
        "[plant]\n",
        "nan",
        "inf",
        "\n",
        "=",
        "true",
        "[",
        "]",
        "{",
        "}",
        "\"",
    ],
    in_a_test: 20_000,
};

fn scenario(input: &[u8], met: &mut Met) {
    let Ok(text) = std::str::from_utf8(input) else {
        return;
    };
    match Scenario::parse("fuzz.toml", text) {
        Ok(scenario) => met.saw(("scenario", scenario.ticks().ilog2())),
        Err(error) => met.saw(("scenario", kind_of(&error.to_string()))),
    }
    match Mission::parse("fuzz.toml", text) {
        Ok(mission) => {
            assert!(mission.longest_s().is_finite() && mission.period_s > 0.0);
            mission.base.validate().expect("what is read was checked");
            met.saw("mission");
        }
        Err(error) => met.saw(("mission", kind_of(&error.to_string()))),
    }
}

/// Base files: what is read gives parameters of a base, or the error of one field.
pub const BASE: Target = Target {
    name: "base-file",
    run: base,
    seeds: || folder("bases", 8_000),
    longest: 6_000,
    words: &[
        "[robot]\n",
        "[limits]\n",
        "[motor]\n",
        "[battery]\n",
        "[friction]\n",
        "[encoder]\n",
        "[pose_source]\n",
        "[control]\n",
        "[gains]\n",
        "[policy]\n",
        "m = ",
        "I = ",
        "\"release\"",
        "\"brake\"",
        "nan",
        "inf",
        "\n",
        "=",
        "true",
        "{",
        "}",
        "\"",
    ],
    in_a_test: 20_000,
};

fn base(input: &[u8], met: &mut Met) {
    let Ok(text) = std::str::from_utf8(input) else {
        return;
    };
    match BaseSpec::parse("fuzz.toml", text) {
        Ok(base) => {
            base.validate().expect("what is read was checked");
            let params = sim_host::closed_loop::params(&base, 10_000);
            let valid = params.map(|params| params.validate().is_ok());
            met.saw(("base", valid.ok(), base.hardware.is_some()));
        }
        Err(error) => met.saw(kind_of(&error.to_string())),
    }
}
