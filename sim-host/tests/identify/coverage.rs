//! The true value lies in the stated 95 % interval in at least 90 % of 200 logs of 200 robots.

use crate::robot::{RECORDER, Recorder, Robot, random, recommended};
use crate::tally::{self, Tallies};
use Quantity as Q;
use sim_host::identify::{Drive, Known, Options, Quantity, Verdict, identify};

const LOGS: usize = 200;

/// A kind of log.
struct Case {
    name: &'static str,
    recorder: Recorder,
    /// What is stated, at its true value.
    stated: &'static [Quantity],
    /// What must be identified in nearly every log; all else must never get a number.
    expected: &'static [Quantity],
}

fn one(case: &Case, seed: u64) -> Tallies {
    let mut random = random(seed);
    let mut robot = Robot::draw(&mut random);
    if !case.stated.contains(&Q::WheelInertia) {
        // Then mass and inertia are said to contain it: without it they do exactly.
        robot.wheel_inertia = 0.0;
    }
    let mut known = Known::default();
    for &quantity in case.stated {
        known.set(quantity, robot.truth(quantity));
    }
    let log = robot.record(&case.recorder, &mut random, recommended);
    let options = Options {
        known,
        latency_s: case.recorder.latency_s,
        ..Options::default()
    };
    let found = identify(&log, &options).expect("no signs are wrong");
    tally::of(&found, &robot)
}

fn check(case: &Case) {
    let tallies = tally::all(LOGS, |seed| one(case, seed));
    tally::print(case.name, &tallies);
    let mut failures = Vec::new();
    for quantity in Q::ALL {
        let tally = tallies[quantity as usize];
        let name = quantity.name();
        if case.expected.contains(&quantity) {
            if tally.given * 100 < LOGS * 95 {
                failures.push(format!("{name}: identified in {} logs", tally.given));
            }
            if tally.within * 10 < tally.given * 9 {
                failures.push(format!(
                    "{name}: {} of {} within",
                    tally.within, tally.given
                ));
            }
        } else if tally.given > 0 {
            failures.push(format!("{name}: {} logs give a number", tally.given));
        }
    }
    assert!(failures.is_empty(), "{}: {failures:#?}", case.name);
}

#[test]
fn a_full_log_tells_everything() {
    check(&Case {
        name: "poses, currents, voltages; wheel inertia stated",
        recorder: RECORDER,
        stated: &[Q::WheelInertia],
        expected: &[
            Q::RadiusRight,
            Q::RadiusLeft,
            Q::Track,
            Q::Mass,
            Q::Inertia,
            Q::MotorConstantRight,
            Q::MotorConstantLeft,
            Q::ResistanceRight,
            Q::ResistanceLeft,
            Q::ViscousRight,
            Q::ViscousLeft,
            Q::CoulombRight,
            Q::CoulombLeft,
        ],
    });
}

#[test]
fn without_poses_no_lengths_no_mass() {
    check(&Case {
        name: "currents, voltages",
        recorder: Recorder {
            pose_sd: None,
            ..RECORDER
        },
        stated: &[],
        expected: &[
            Q::MotorConstantRight,
            Q::MotorConstantLeft,
            Q::ResistanceRight,
            Q::ResistanceLeft,
            Q::ViscousRight,
            Q::ViscousLeft,
            Q::CoulombRight,
            Q::CoulombLeft,
        ],
    });
}

#[test]
fn without_currents_lengths_only() {
    check(&Case {
        name: "poses, duties",
        recorder: Recorder {
            drive: Drive::Duty,
            current_sd: None,
            ..RECORDER
        },
        stated: &[],
        expected: &[Q::RadiusRight, Q::RadiusLeft, Q::Track],
    });
}

#[test]
fn stated_lengths_and_constants_replace_poses_and_currents() {
    check(&Case {
        name: "voltages; lengths, motor constants, wheel inertia stated",
        recorder: Recorder {
            current_sd: None,
            pose_sd: None,
            ..RECORDER
        },
        stated: &[
            Q::RadiusRight,
            Q::RadiusLeft,
            Q::Track,
            Q::WheelInertia,
            Q::MotorConstantRight,
            Q::MotorConstantLeft,
            Q::ResistanceRight,
            Q::ResistanceLeft,
        ],
        expected: &[
            Q::Mass,
            Q::Inertia,
            Q::ViscousRight,
            Q::ViscousLeft,
            Q::CoulombRight,
            Q::CoulombLeft,
        ],
    });
}

#[test]
fn torques_and_poses_tell_the_body() {
    check(&Case {
        name: "poses, torques",
        recorder: Recorder {
            drive: Drive::Torque,
            current_sd: None,
            ..RECORDER
        },
        stated: &[],
        expected: &[
            Q::RadiusRight,
            Q::RadiusLeft,
            Q::Track,
            Q::Mass,
            Q::Inertia,
            Q::ViscousRight,
            Q::ViscousLeft,
            Q::CoulombRight,
            Q::CoulombLeft,
        ],
    });
}

/// Efforts of a firmware that makes up for friction are less than the torque by it, and more: what is left is no friction.
#[test]
fn friction_that_pushes_is_no_number() {
    let robot = Robot::draw(&mut random(7));
    let recorder = Recorder {
        drive: Drive::Torque,
        current_sd: None,
        ..RECORDER
    };
    let recorded = robot.record(&recorder, &mut random(8), recommended);
    let coulomb = [Q::CoulombRight, Q::CoulombLeft];
    let options = Options {
        latency_s: recorder.latency_s,
        ..Options::default()
    };
    let made_up_for = |times: f64| {
        let mut log = recorded.clone();
        for row in 1..log.t.len() {
            for (i, &quantity) in coulomb.iter().enumerate() {
                let turned = log.angle[row][i] - log.angle[row - 1][i];
                if turned != 0.0 {
                    log.command[row][i] -= times * robot.truth(quantity) * turned.signum();
                }
            }
        }
        identify(&log, &options).expect("signs agree")
    };
    // What is found is below 0 by a little more in each: no value has its whole interval there, for either wheel.
    let (mut values, mut below, mut none) = (0, 0, 0);
    for step in 0..40 {
        let found = made_up_for(1.0 + 1.0e-4 * f64::from(step));
        for quantity in coulomb {
            match found.of(quantity) {
                Some(Verdict::Identified { value, half_width }) => {
                    assert!(value + half_width >= 0.0, "{value} ± {half_width}");
                    values += 1;
                    below += usize::from(*value < 0.0);
                }
                Some(Verdict::NotIdentifiable { .. }) => none += 1,
                other => panic!("{other:?}"),
            }
        }
    }
    println!("{values} values, {below} of them below 0; {none} not identifiable");
    assert!(
        below > 0 && none > 0,
        "{values} values, {none} not identifiable"
    );
    let found = made_up_for(2.0);
    for quantity in coulomb {
        match found.of(quantity) {
            Some(Verdict::NotIdentifiable { why, .. }) => {
                assert!(why.contains("friction does not push"), "{why}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(
        matches!(found.of(Q::Mass), Some(Verdict::Identified { .. })),
        "{found:?}"
    );
}
