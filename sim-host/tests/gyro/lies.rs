//! Gyros that lie while the base drives: each is found by its name, and the base goes on by its wheels.

use crate::rig::{Draw, Rig, Wander, bad_floor, mission, seeds};
use controller_core::gyro::GyroFault;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::{Fault, FaultKind};
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;
use sim_host::world::PlantFault;

fn run(base: &BaseSpec, seed: u64, fault: PlantFault) -> (Option<Fault>, f64, f64, bool) {
    let setup = bad_floor(base, seed);
    let mut queue = ReferenceQueue::new();
    let mission = mission(base);
    let mut rig = Rig::start(&mut queue, &mission, &setup);
    let mut wander = Wander::new(base, seed);
    let at_s = Draw::new(seed ^ 0x11e).between(3.0, 6.0);
    let (mut lying, mut found, mut worst) = (false, None, 0.0_f64);
    let mut stopped = false;
    while rig.t < 20.0 {
        if !lying && rig.t > at_s {
            rig.base.world_mut().inject(fault);
            lying = true;
        }
        let report = rig.tick(&wander.at(rig.t));
        let gyro = report.active_faults.get(FaultKind::Gyro);
        if std::env::var("V").is_ok() && report.active_faults.iter().next().is_some() && found.is_none() {
            println!("  {:.3} {:?} {:?}", rig.t - at_s, report.active_faults.iter().collect::<Vec<_>>(), report.gyro);
        }
        if found.is_none() && gyro.is_some() {
            found = gyro.map(|fault| (fault, rig.t - at_s));
        }
        worst = worst.max(rig.heading_error().abs());
        if !report.state.is_live() && rig.t > 1.1 {
            println!("{} {seed}: {:.3} {:?} {:?}", base.name, rig.t - at_s, report.cause, report.state);
            stopped = true;
            break;
        }
    }
    let (fault, after) = found.map_or((None, f64::NAN), |(fault, after)| (Some(fault), after));
    (fault, after, worst, stopped)
}

#[test]
fn gyros_that_lie_are_found() {
    for (name, fault, expected) in [
        ("silent", PlantFault::GyroSilent, GyroFault::Silent),
        ("NaN", PlantFault::GyroNan, GyroFault::Silent),
        ("stuck", PlantFault::GyroStuck, GyroFault::Stuck),
        ("reversed", PlantFault::GyroScale { factor: -1.0 }, GyroFault::Reversed),
        ("scale 0.5", PlantFault::GyroScale { factor: 0.5 }, GyroFault::Disagrees),
        ("scale 1.3", PlantFault::GyroScale { factor: 1.3 }, GyroFault::Disagrees),
        ("bias", PlantFault::GyroBias { rad_s: 0.4 }, GyroFault::Disagrees),
    ] {
        for built_in in BASES {
            let base = built_in.with_gyro().expect("valid");
            let runs: Vec<_> = seeds(10).map(|seed| run(&base, seed, fault)).collect();
            let right = runs.iter().filter(|run| run.0 == Some(Fault::Gyro(expected))).count();
            let stopped = runs.iter().filter(|run| run.3).count();
            let latest = runs.iter().map(|run| run.1).fold(0.0, f64::max);
            let worst = runs.iter().map(|run| run.2).fold(0.0, f64::max);
            println!("{:?}", runs.iter().filter(|run| run.0 != Some(Fault::Gyro(expected))).collect::<Vec<_>>());
            println!("{name} {}: {right} of {}, latest {latest:.2} s, heading {worst:.3}, stopped {stopped}", built_in.name, runs.len());
        }
    }
}
