//! Instructions that a simulated tick takes on the host, counted by valgrind: on a busy machine there are as many.
//!
//! A program parks the 10 kg base from seeded poses, first some times, then more often. What that takes more, by the ticks
//! that it has more, is free of the program's start.

use std::path::Path;
use std::process::Command;

use controller_core::types::{Measured, Pose, Twist};
use sim_host::mission::{Course, End, Mission};
use sim_host::precision::Precision;
use sim_host::run::finish;
use sim_host::scenario::BuiltInBase;
use sim_host::trials::{Condition, setup};

use crate::random::Random;
use crate::stated::{At, Stated};

/// What is counted.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// As on the command line of the program.
    pub name: &'static str,
    /// First cell of its row in the document.
    row: &'static str,
    period_s: f64,
    whole_base: bool,
}

/// All that is counted.
pub const CASES: [Case; 3] = [
    Case {
        name: "law",
        row: "default law on the ideal plant, 1 ms",
        period_s: 0.001,
        whole_base: false,
    },
    Case {
        name: "law-10-ms",
        row: "the same at 10 ms: the plant takes two steps a tick, at most 5 ms each",
        period_s: 0.01,
        whole_base: false,
    },
    Case {
        name: "base",
        row: "whole base on the realistic plant, 10 ms",
        period_s: 0.01,
        whole_base: true,
    },
];

/// Parks, few and many: a second or so of valgrind, and ticks by the thousand of all that a park has.
const PARKS: [usize; 2] = [1, 7];

/// Whether the program is as tests are built, or as `cargo run --release` builds it.
const COLUMN: &str = if cfg!(debug_assertions) {
    "instructions a tick, in a test"
} else {
    "instructions a tick, released"
};

impl Case {
    /// So many parks; the number of their ticks.
    ///
    /// # Panics
    /// A park that does not end parked.
    pub fn run(&self, parks: usize) -> usize {
        let base = BuiltInBase::find("lab-10kg")
            .expect("a built-in base")
            .base();
        let base = base.unwrap_or_else(|error| panic!("{error}"));
        let mut random = Random(1);
        let mut ticks = 0;
        for seed in 0..parks {
            let [x, y, theta] = [2.0, 2.0, std::f64::consts::PI].map(|scale| random.within(scale));
            let mission = Mission {
                name: self.name.to_owned(),
                description: String::new(),
                robot: base.robot,
                precision: Precision::F32,
                start: Measured {
                    pose: Pose::new(x, y, theta),
                    twist: Twist::default(),
                },
                course: Course::Park(Pose::default()),
                events: Vec::new(),
                period_s: self.period_s,
                end: End::Parked(60.0),
                setup: self
                    .whole_base
                    .then(|| setup(&base, Condition::Drawn, seed as u64)),
                base: base.clone(),
            };
            let run = finish(&mission, &mut || {}).unwrap_or_else(|error| panic!("{error}"));
            let run = run.expect("some ticks");
            assert!(run.parked_since_s.is_some(), "park {seed} of {}", self.name);
            ticks += run.ticks;
        }
        ticks
    }
}

/// Instructions and ticks of a program that runs so many parks.
fn counted(program: &Path, case: &Case, parks: usize) -> (f64, f64) {
    let mut valgrind = Command::new("valgrind");
    valgrind
        .args([
            "--tool=cachegrind",
            "--cache-sim=no",
            "--cachegrind-out-file=/dev/null",
        ])
        .arg(program)
        .args([case.name, &parks.to_string()]);
    let output = valgrind.output().unwrap_or_else(|error| {
        panic!("valgrind: {error}; `sh tests/run` installs the distribution's package valgrind")
    });
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{valgrind:?}\n{said}");
    let instructions = said
        .lines()
        .find_map(|line| line.split_once("I   refs:"))
        .and_then(|(_, count)| count.trim().replace(',', "").parse().ok());
    let ticks = String::from_utf8_lossy(&output.stdout).trim().parse().ok();
    instructions
        .zip(ticks)
        .unwrap_or_else(|| panic!("{valgrind:?}\n{said}"))
}

/// Counts all cases and compares them with what the document states.
///
/// # Panics
/// Without valgrind; with other figures than are stated.
pub fn compare(program: &Path) {
    let mut stated = Stated::of("docs/python.md");
    for case in &CASES {
        let [few, many] = PARKS.map(|parks| counted(program, case, parks));
        let each = (many.0 - few.0) / (many.1 - few.1);
        println!("{}, {COLUMN}: {each:.0}", case.row);
        // A hundredth or two for how the compiler splits and inlines what it is given, and what the system's own libraries take to copy.
        stated.to_a_digit(At::Cell("Speed and size", case.row, COLUMN), &[1e-3 * each]);
    }
}
