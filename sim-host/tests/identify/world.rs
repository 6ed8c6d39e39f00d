//! Intervals on logs of the realistic plant, which is not the model that is fitted.

use crate::plant::{plant, record, same_on_both_sides, without_lag};
use crate::robot::{Robot, random, recommended};
use crate::tally::{self, Tallies};
use Quantity as Q;
use sim_host::identify::{Identified, Known, Options, Quantity, Verdict, identify};
use sim_host::world::WorldParams;

/// A fault of the plant that the model does not have.
type Unkind = fn(&mut WorldParams);

fn identified(seed: u64, unkind: Unkind) -> (Identified, Robot) {
    let mut random = random(seed);
    let mut robot = Robot::draw(&mut random);
    same_on_both_sides(&mut robot);
    let mut params = plant(&robot);
    unkind(&mut params);
    let mut known = Known::default();
    known.set(Q::WheelInertia, robot.wheel_inertia);
    let log = record(&params, seed, 25.0, recommended);
    let latency_s = params.pose_source.map_or(0.0, |source| source.latency_s);
    let options = Options {
        known,
        latency_s,
        ..Options::default()
    };
    let found = identify(&log, &options).expect("no signs are wrong");
    (found, robot)
}

fn one(seed: u64, unkind: Unkind) -> Tallies {
    let (found, robot) = identified(seed, unkind);
    tally::of(&found, &robot)
}

/// What a log with poses, currents and voltages tells.
fn told() -> impl Iterator<Item = Quantity> {
    let stated = [Q::WheelInertia, Q::Supply];
    Q::ALL.into_iter().filter(move |q| !stated.contains(q))
}

fn misses(
    tallies: &Tallies,
    quantities: impl Iterator<Item = Quantity>,
    logs: usize,
) -> Vec<String> {
    let missed = |quantity: &Quantity| {
        let tally = tallies[*quantity as usize];
        // With a true share of 95 % one of thirteen quantities is below 86 % of 60 by chance in one of
        // fifty draws of the seeds: what is below has another reason.
        tally.given < logs || tally.within * 100 < logs * 86
    };
    let name = |q: Quantity| format!("{}: {} within", q.name(), tallies[q as usize].within);
    quantities.filter(missed).map(name).collect()
}

/// Motors at once at their current; stiction, Coulomb's law with a corner, counts and late poses.
#[test]
fn intervals_hold_on_the_realistic_plant() {
    const LOGS: usize = 60;
    let tallies = tally::all(LOGS, |seed| one(seed, without_lag));
    tally::print("world, without windings", &tallies);
    let failures = misses(&tallies, told(), LOGS);
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Windings of 0.5 ms beside that.
#[test]
fn intervals_hold_with_windings() {
    const LOGS: usize = 60;
    let tallies = tally::all(LOGS, |seed| one(seed, |_| {}));
    tally::print("world, windings of 0.5 ms", &tallies);
    let failures = misses(&tallies, told(), LOGS);
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Beside that what the bases have: gears that lose, drivers with a dead band, a battery that sags.
#[test]
fn intervals_hold_with_losses() {
    const LOGS: usize = 60;
    let lossy: Unkind = |p| {
        p.battery.internal_ohm = 0.1;
        motor(p, |m| {
            m.gear_efficiency = 0.9;
            m.dead_band = 0.02;
        });
    };
    let tallies = tally::all(LOGS, |seed| one(seed, lossy));
    tally::print(
        "world, gear 0.9, dead band of 2 %, battery of 0.1 ohm",
        &tallies,
    );
    let failures = misses(&tallies, told(), LOGS);
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn the_lag_of_windings_is_told() {
    let (found, _) = identified(0, |_| {});
    for name in ["lag_right", "lag_left"] {
        let entry = found.combinations.iter().find(|e| e.name == name);
        match entry.map(|e| &e.verdict) {
            Some(Verdict::Identified { value, half_width }) => {
                // Of 0.5 ms, a tenth: less would not be worth telling.
                assert!(*half_width < 5.0e-5, "{name}: {half_width}");
                // The plant's substeps of 0.25 ms add 0.01 ms; an interval of 95 % is left by one of
                // two lags in ten logs, twice as wide in one of 10,000.
                assert!(
                    (value - 5.0e-4).abs() < 2.0 * half_width + 1.0e-5,
                    "{name}: {value}"
                );
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// A fault, and how far off on average it leaves mass and inertia, motor constants, resistances, viscous and
/// Coulomb friction, the worse side of each \[%\]: the table in `docs/identify.md`.
type Shift = (&'static str, Unkind, [f64; 5]);

const SHIFTS: [Shift; 3] = [
    (
        "tyres that slip a little",
        |p| {
            p.floor.mu = 0.8;
            p.floor.slip_stiffness = 20.0;
        },
        [0.1, 0.1, 0.6, 5.0, 3.0],
    ),
    (
        "slope of 1:200",
        |p| p.floor.slope_rad = 0.005,
        [0.7, 0.2, 0.3, 3.0, 11.0],
    ),
    (
        "ticks 0.2 ms uneven",
        |p| p.tick.jitter_us = 200,
        [0.1, 0.0, 0.1, 0.2, 0.1],
    ),
];

/// What the model does not have shifts the figures by no more than the docs say; lengths hardly at all.
#[test]
fn what_the_model_lacks_shifts_as_little_as_the_docs_say() {
    const LOGS: usize = 60;
    let mut failures = Vec::new();
    for (name, unkind, shifts) in SHIFTS {
        let tallies = tally::all(LOGS, |seed| one(seed, unkind));
        tally::print(name, &tallies);
        let [body, constant, resistance, viscous, coulomb] = shifts;
        for quantity in told() {
            let shift = match quantity {
                Q::RadiusRight | Q::RadiusLeft | Q::Track => 0.1,
                Q::MotorConstantRight | Q::MotorConstantLeft => constant,
                Q::ResistanceRight | Q::ResistanceLeft => resistance,
                Q::ViscousRight | Q::ViscousLeft => viscous,
                Q::CoulombRight | Q::CoulombLeft => coulomb,
                _ => body,
            };
            let error = tallies[quantity as usize].error_percent();
            // The table is rounded, to tenths below 2 % and to whole numbers from there.
            let rounding = if shift < 2.0 { 0.1 } else { 0.5 };
            if error.abs() > shift + rounding {
                failures.push(format!("{name}, {}: {error:.2} % off", quantity.name()));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

fn motor(params: &mut WorldParams, edit: impl Fn(&mut sim_host::world::MotorParams)) {
    params.motor.iter_mut().for_each(edit);
}
