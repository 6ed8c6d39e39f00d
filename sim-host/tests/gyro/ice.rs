//! A wheel on ice, found by the gyro.

use crate::rig::{Draw, Rig, Wander, bad_floor, is_as_stated, is_fresh, mission, seeds};
use controller_core::queue::ReferenceQueue;
use controller_core::safety::FaultKind;
use sim_host::mission::BaseSpec;
use sim_host::rate::Rate;
use sim_host::scenario::BASES;
use sim_host::world::{PlantFault, Side};
use tests::stated::{At, Stated};

/// A wheel slides that goes faster over the floor \[m/s\].
const SLIDES: f64 = 0.1;
/// A wheel that goes faster over the floor slides at all \[m/s\]: three times what a radius that is off by a per cent makes of 1 m/s.
const SLIDES_AT_ALL: f64 = 0.03;
/// What is found began to slide at most so long ago \[s\].
const LATELY_S: f64 = 0.5;
/// Found within \[s\].
const WITHIN_S: f64 = 0.3;
/// Runs of each base.
const RUNS: u64 = 20;

#[derive(Debug, Default)]
struct Outcome {
    /// For how long a wheel had slid without a break when the fault was found \[s\]; `None` where it was not.
    found_s: Option<f64>,
    /// Found although neither wheel had slid lately.
    false_alarm: bool,
    /// Longest slide of which the base did not know \[s\]: that had not turned its heading over to the gyro, nor stopped it.
    unseen_s: f64,
    /// A slide that lasted [`WITHIN_S`] and was not found.
    missed: bool,
}

/// Speed of a wheel's rim over the floor \[m/s\], to the per cent that the radii of the bad floor are off by.
fn slide(rig: &Rig<'_>, base: &BaseSpec, side: Side) -> f64 {
    let (truth, speeds) = (rig.world().truth().twist, rig.world().wheel_speeds());
    let wheels = &base.robot.wheels;
    let turning = 0.5 * wheels.track_m * truth.angular;
    match side {
        Side::Right => speeds.right * wheels.radius_right_m - truth.linear - turning,
        Side::Left => speeds.left * wheels.radius_left_m - truth.linear + turning,
    }
}

fn run(base: &BaseSpec, seed: u64, ice: bool) -> Outcome {
    let setup = bad_floor(base, seed);
    let mut queue = ReferenceQueue::new();
    let mission = mission(base);
    let mut rig = Rig::start(&mut queue, &mission, &setup);
    let mut wander = Wander::new(base, seed);
    let mut draw = Draw::new(seed ^ 0x1ce);
    let side = if draw.between(0.0, 1.0) < 0.5 {
        Side::Right
    } else {
        Side::Left
    };
    let (at_s, mu) = (draw.between(3.0, 6.0), draw.between(0.05, 0.2));
    let (mut outcome, mut sliding_s, mut unseen_s) = (Outcome::default(), 0.0, 0.0);
    let mut still_s = f64::INFINITY;
    let mut frozen = !ice;
    while rig.t < 12.0 {
        if !frozen && rig.t > at_s {
            let fault = PlantFault::WheelOnIce { side, mu };
            rig.base.world_mut().inject(fault);
            frozen = true;
        }
        let order = wander.at(rig.t);
        let report = rig.tick(&order);
        let [right, left] = [Side::Right, Side::Left].map(|side| slide(&rig, base, side).abs());
        still_s = if right.max(left) > SLIDES_AT_ALL {
            0.0
        } else {
            still_s + rig.dt
        };
        if report.active_faults.get(FaultKind::WheelSlip).is_some() {
            outcome.found_s = Some(sliding_s);
            outcome.false_alarm = still_s > LATELY_S;
            return outcome;
        }
        if !report.state.is_live() {
            return outcome;
        }
        let slides = match side {
            Side::Right => right,
            Side::Left => left,
        } > SLIDES;
        sliding_s = if slides { sliding_s + rig.dt } else { 0.0 };
        let unseen = slides && report.gyro.slid == 0.0;
        unseen_s = if unseen { unseen_s + rig.dt } else { 0.0 };
        outcome.unseen_s = outcome.unseen_s.max(unseen_s);
        outcome.missed |= sliding_s > WITHIN_S;
    }
    outcome
}

/// The same drives with a wheel on ice from a random moment on, with a gyro and without one, and with a gyro on the same bad floors
/// without ice, where a wheel may be found that does slide, which tyres on the worst of them do, and no other.
///
/// `GYRO_SEED` and `GYRO_SEEDS` are another first seed and another number.
#[test]
fn a_wheel_on_ice_is_found_within_three_tenths_of_a_second() {
    let (mut missed, mut stopped) = (Rate::default(), Rate::default());
    let (mut found, mut unseen, mut quietly) = (Vec::new(), Vec::new(), Vec::new());
    for built_in in BASES {
        let (with, without) = (
            built_in.with_gyro().expect("valid"),
            built_in.base().expect("valid"),
        );
        let runs = |base: &BaseSpec, ice| -> Vec<Outcome> {
            let runs = seeds(RUNS);
            runs.map(|seed| run(base, seed, ice)).collect()
        };
        let (gyro, wheels, quiet) = (runs(&with, true), runs(&without, true), runs(&with, false));
        let count = |runs: &[Outcome], what: fn(&Outcome) -> bool| {
            runs.iter().filter(|outcome| what(outcome)).count()
        };
        let finds = gyro.iter().filter_map(|run| run.found_s);
        let latest = finds.fold(0.0, f64::max);
        let of_ice = [
            count(&gyro, |run| run.found_s.is_some()),
            count(&gyro, |run| run.missed),
            count(&wheels, |run| run.missed),
        ];
        let without_ice = [
            count(&quiet, |run| run.found_s.is_some() && !run.false_alarm),
            count(&quiet, |run| run.false_alarm),
        ];
        println!(
            "{}: {of_ice:?} found, missed, missed without a gyro, of {}, the latest after {latest:.3} s; {without_ice:?} stopped without ice while a wheel slid, and while none did",
            built_in.name,
            gyro.len(),
        );
        missed.failed += of_ice[1];
        missed.runs += count(&gyro, |run| run.missed || run.found_s.is_some());
        stopped.failed += without_ice[1];
        stopped.runs += quiet.len();
        assert!(of_ice[0] > 0);
        // The condition is not empty: a base without a gyro slides on unaware.
        assert_eq!(count(&wheels, |run| run.found_s.is_some()), 0);
        assert!(
            is_fresh() || latest <= WITHIN_S,
            "{}: {latest}",
            built_in.name
        );
        found.extend([latest, of_ice[0] as f64]);
        unseen.extend([of_ice[1] as f64, of_ice[2] as f64]);
        quietly.extend(without_ice.map(|runs| runs as f64));
    }
    let stated = |phrase| Stated::of("docs/gyro.md").numbers(At::Phrase(phrase));
    is_as_stated("missed", missed, &stated("missed # of # slides"));
    is_as_stated(
        "stopped",
        stopped,
        &stated("stopped # of # drives without ice while no wheel slid"),
    );
    if !is_fresh() {
        assert_eq!((missed.failed, stopped.failed), (0, 0));
        let mut page = Stated::of("docs/gyro.md");
        for (row, figures) in [
            (
                "a wheel on ice, sliding faster than 0.1 m/s: found after at most [s]; in so many runs",
                found,
            ),
            (
                "slides of 0.3 s that were missed, with a gyro; without",
                unseen,
            ),
            (
                "stopped where there is no ice, while a wheel of the bad floor slid; while none did",
                quietly,
            ),
        ] {
            page.exactly(At::Row("Measured", row), &figures);
        }
    }
}
