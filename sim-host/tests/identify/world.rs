//! Intervals on logs of the realistic plant, which is not the model that is fitted.

use crate::plant::{plant, record, same_on_both_sides, without_lag};
use crate::robot::{Robot, random, recommended};
use crate::tally::{self, Tallies};
use Quantity as Q;
use sim_host::identify::{Identified, Known, Options, Quantity, Verdict, identify};
use sim_host::world::WorldParams;
use tests::stated::{At, Stated};

/// A fault of the plant that the model does not have.
type Unkind = fn(&mut WorldParams);

fn identified(seed: u64, unkind: Unkind, stated: &str) -> (Identified, Robot) {
    let mut random = random(seed);
    let mut robot = Robot::draw(&mut random);
    same_on_both_sides(&mut robot);
    let mut params = plant(&robot);
    unkind(&mut params);
    let mut known = Known::default();
    known.state(stated).expect("names");
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

fn one(seed: u64, unkind: Unkind, stated: &str) -> Tallies {
    let (found, robot) = identified(seed, unkind, stated);
    tally::of(&found, &robot)
}

/// What each group of columns in `docs/identify.md` is about.
const GROUPS: [&[Quantity]; 6] = [
    &[Q::RadiusRight, Q::RadiusLeft, Q::Track],
    &[Q::Mass, Q::Inertia],
    &[Q::MotorConstantRight, Q::MotorConstantLeft],
    &[Q::ResistanceRight, Q::ResistanceLeft],
    &[Q::ViscousRight, Q::ViscousLeft],
    &[Q::CoulombRight, Q::CoulombLeft],
];

/// The document states share within and size of the mean error, of the worse side of each group.
fn as_stated(row: &str, tallies: &Tallies) {
    let worst = |group: &[Quantity]| {
        let of = group.iter().map(|q| &tallies[*q as usize]);
        let share = |t: &tally::Tally| 100.0 * t.within as f64 / t.given as f64;
        let least = of.clone().map(share).fold(100.0, f64::min);
        [
            least,
            of.map(|t| t.error_percent().abs()).fold(0.0, f64::max),
        ]
    };
    let measured: Vec<_> = GROUPS.iter().flat_map(|group| worst(group)).collect();
    let mut page = Stated::of("docs/identify.md");
    page.about(At::Row("Other plants", row), &measured);
}

/// Nothing that the log has to tell.
const NOTHING: &str = "gear=20";

/// What a log with poses, currents and voltages tells.
fn quantities() -> impl Iterator<Item = Quantity> {
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
    let tallies = tally::all(LOGS, |seed| one(seed, without_lag, NOTHING));
    as_stated("as the model", &tallies);
    let failures = misses(&tallies, quantities(), LOGS);
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Windings of 0.5 ms beside that.
#[test]
fn intervals_hold_with_windings() {
    const LOGS: usize = 60;
    let tallies = tally::all(LOGS, |seed| one(seed, |_| {}, NOTHING));
    as_stated("windings, L/R = 0.5 ms", &tallies);
    let failures = misses(&tallies, quantities(), LOGS);
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
    let tallies = tally::all(LOGS, |seed| one(seed, lossy, NOTHING));
    as_stated("windings, gear, dead band, battery", &tallies);
    let failures = misses(&tallies, quantities(), LOGS);
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn the_lag_of_windings_is_told() {
    let (found, _) = identified(0, |_| {}, NOTHING);
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

/// A fault, and how far off on average it leaves mass and inertia, motor constants, resistances, viscous and Coulomb
/// friction at most, the worse side of each \[%\]. That the plant has no gear losses and no dead band is stated.
type Shift = (&'static str, Unkind, [f64; 5]);

const SHIFTS: [Shift; 3] = [
    (
        "windings, tyres of stiffness 20",
        |p| {
            p.floor.mu = 0.8;
            p.floor.slip_stiffness = 20.0;
        },
        [0.4, 0.1, 0.6, 6.0, 6.0],
    ),
    (
        "windings, slope of 1:200",
        |p| p.floor.slope_rad = 0.005,
        // Stretches leave out 50 ms about each reversal, where a wheel may have stood and its mean speed hides it. With
        // these rows the mass is off by 0.9 here, and tyres shift more: 0.5, 0.2, 0.7, 6.7 and 6.5.
        [1.0, 0.1, 0.1, 8.0, 8.0],
    ),
    (
        "windings, ticks 0.2 ms uneven",
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
        let tallies = tally::all(LOGS, |seed| one(seed, unkind, "efficiency=1,dead_band=0"));
        as_stated(name, &tallies);
        let [body, constant, resistance, viscous, coulomb] = shifts;
        for quantity in quantities() {
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
