//! The heading by itself: wheels alone, and wheels with a gyro, on the same floors.

use crate::rig::{Rig, Wander, bad_floor, mission, seeds};
use controller_core::queue::ReferenceQueue;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;

/// \[s\].
const DRIVE_S: f64 = 60.0;

/// Error of the heading after a minute of driving by velocity, without external poses \[rad\].
fn drift(mut base: BaseSpec, seed: u64) -> f64 {
    if let Some(hardware) = &mut base.hardware {
        hardware.pose_source = None;
    }
    let setup = bad_floor(&base, seed);
    let mut queue = ReferenceQueue::new();
    let mission = mission(&base);
    let mut rig = Rig::start(&mut queue, &mission, &setup);
    let mut wander = Wander::new(&base, seed);
    while rig.t < DRIVE_S {
        let order = wander.at(rig.t);
        let report = rig.tick(&order);
        if report.active_faults.iter().next().is_some() && std::env::var("V").is_ok() {
            println!("{} {:.3} {:?} {:?}", base.name, rig.t, report.active_faults.iter().collect::<Vec<_>>(), report.gyro);
        }
    }
    rig.heading_error()
}

#[test]
fn a_gyro_holds_the_heading_ten_times_better_than_wheels() {
    for built_in in BASES {
        let (mut wheels, mut gyro) = (0.0, 0.0);
        for seed in seeds(20) {
            let (by_wheels, by_gyro) = (
                drift(built_in.base().expect("valid"), seed),
                drift(built_in.with_gyro().expect("valid"), seed),
            );
            println!("{seed} {by_wheels:.4} {by_gyro:.5}");
            wheels += by_wheels * by_wheels;
            gyro += by_gyro * by_gyro;
        }
        let ratio = f64::sqrt(wheels / gyro);
        println!("{}: {ratio:.1}", built_in.name);
        assert!(ratio > 10.0, "{}: {ratio}", built_in.name);
    }
}
