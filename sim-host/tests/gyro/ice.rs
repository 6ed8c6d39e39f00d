//! A wheel on ice, found by the gyro.

use crate::rig::{Draw, Rig, Wander, bad_floor, mission, seeds};
use controller_core::queue::ReferenceQueue;
use controller_core::safety::FaultKind;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;
use sim_host::world::{PlantFault, Side};

/// A wheel slides that goes faster over the floor \[m/s\].
const SLIDES: f64 = 0.1;
/// Found within \[s\].
const WITHIN_S: f64 = 0.3;

#[derive(Debug, Default)]
struct Found {
    /// The iced wheel slid for so long without a break before the fault was found, or at most \[s\].
    fault_s: f64,
    /// And before the heading went by the gyro.
    seen_s: f64,
    found: bool,
    /// A slide that lasted [`WITHIN_S`] without being found.
    missed: bool,
}

/// Speed of a wheel's rim over the floor \[m/s\].
fn slide(rig: &Rig<'_>, base: &BaseSpec, side: Side) -> f64 {
    let (truth, speeds) = (rig.world().truth().twist, rig.world().wheel_speeds());
    let half = 0.5 * base.robot.wheels.track_m * 1.02;
    match side {
        Side::Right => speeds.right * base.robot.wheels.radius_right_m - truth.linear - half * truth.angular,
        Side::Left => speeds.left * base.robot.wheels.radius_left_m - truth.linear + half * truth.angular,
    }
}

fn run(base: &BaseSpec, seed: u64, ice: bool) -> Found {
    let setup = bad_floor(base, seed);
    let mut queue = ReferenceQueue::new();
    let mission = mission(base);
    let mut rig = Rig::start(&mut queue, &mission, &setup);
    let mut wander = Wander::new(base, seed);
    let mut draw = Draw::new(seed ^ 0x1ce);
    let side = if draw.between(0.0, 1.0) < 0.5 { Side::Right } else { Side::Left };
    let (at_s, mu) = (draw.between(3.0, 6.0), draw.between(0.05, 0.2));
    let (mut found, mut sliding_s, mut seen_s, mut on_ice) = (Found::default(), 0.0, 0.0, false);
    while rig.t < 12.0 {
        if ice && !on_ice && rig.t > at_s {
            rig.base.world_mut().inject(PlantFault::WheelOnIce { side, mu });
            on_ice = true;
        }
        let report = rig.tick(&wander.at(rig.t));
        let slid = slide(&rig, base, side).abs().max(if ice { 0.0 } else {
            slide(&rig, base, if side == Side::Right { Side::Left } else { Side::Right }).abs()
        });
        sliding_s = if slid > SLIDES { sliding_s + rig.dt } else { 0.0 };
        seen_s = if slid > SLIDES && report.gyro.slid == 0.0 { seen_s + rig.dt } else { 0.0 };
        found.seen_s = found.seen_s.max(seen_s);
        if let Some(fault) = report.active_faults.iter().next()
            && report.state.is_live()
            && std::env::var("V").is_ok()
        {
            println!("  {:.3} {fault} slid {slid:.3} {:?}", rig.t, report.gyro);
        }
        if report.active_faults.get(FaultKind::WheelSlip).is_some() {
            found.found = true;
            found.fault_s = sliding_s;
            break;
        }
        if !report.state.is_live() && rig.t > 1.1 {
            println!("{} {seed}: {:?} {:?}", base.name, report.cause, report.state);
            break;
        }
        if sliding_s > WITHIN_S {
            if !found.missed && ice { println!("  {} {seed} {:.3} slid {slid:.3} {:?} {:?}", base.name, rig.t, report.gyro, rig.world().truth().twist); }
            found.missed = true;
            found.fault_s = found.fault_s.max(sliding_s);
        }
    }
    found
}

#[test]
fn a_wheel_on_ice_is_found_within_three_tenths_of_a_second() {
    for built_in in BASES {
        let (with, without) = (built_in.with_gyro().expect("valid"), built_in.base().expect("valid"));
        for (name, base, ice) in [("gyro", &with, true), ("no gyro", &without, true), ("no ice", &with, false)] {
            let runs: Vec<_> = seeds(20).map(|seed| run(base, seed, ice)).collect();
            let found = runs.iter().filter(|run| run.found).count();
            let missed = runs.iter().filter(|run| run.missed).count();
            let most = |what: fn(&Found) -> f64| runs.iter().map(what).fold(0.0, f64::max);
            println!("{} {name}: found {found} missed {missed} fault {:.3} seen {:.3}", built_in.name,
                most(|run| if run.found { run.fault_s } else { 0.0 }), most(|run| run.seen_s));
        }
    }
}
