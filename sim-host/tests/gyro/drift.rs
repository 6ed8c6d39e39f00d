//! The heading by itself: wheels alone, and wheels with a gyro, on the same floors.

use crate::rig::{Rig, Wander, bad_floor, is_fresh, mission, seeds};
use controller_core::queue::ReferenceQueue;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;
use tests::stated::{At, Stated};

/// Runs of each base.
const RUNS: u64 = 20;
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
        rig.tick(&order);
    }
    rig.heading_error()
}

#[test]
fn a_gyro_holds_the_heading_ten_times_better_than_wheels() {
    let (mut by_wheels, mut by_gyro) = (Vec::new(), Vec::new());
    for built_in in BASES {
        let (mut wheels, mut gyro) = (0.0, 0.0);
        for seed in seeds(RUNS) {
            wheels += drift(built_in.base().expect("valid"), seed).powi(2);
            gyro += drift(built_in.with_gyro().expect("valid"), seed).powi(2);
        }
        let ratio = f64::sqrt(wheels / gyro);
        let runs = seeds(RUNS).count() as f64;
        let rms = |sum: f64| 1e3 * f64::sqrt(sum / runs);
        println!(
            "{}: {:.0} mrad by wheels, {:.1} with a gyro, {ratio:.1} times less",
            built_in.name,
            rms(wheels),
            rms(gyro)
        );
        assert!(ratio > 10.0, "{}: {ratio}", built_in.name);
        by_wheels.push(rms(wheels));
        by_gyro.extend([rms(gyro), ratio]);
    }
    if !is_fresh() {
        let mut page = Stated::of("docs/gyro.md");
        let row = "heading after 60 s without poses, RMS [mrad], by wheels";
        page.exactly(At::Row("Measured", row), &by_wheels);
        let row = "with a gyro; so many times less";
        page.exactly(At::Row("Measured", row), &by_gyro);
    }
}
