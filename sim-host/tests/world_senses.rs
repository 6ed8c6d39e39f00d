//! Senses of `world`: quantisation, latency, statistics, streams, seeds, keys.

use crate::world_common::*;
use controller_core::types::Measured;
use sim_host::world::{Actuation, PlantFault, PoseSourceParams, Side, World, WorldKeys, presets};
use std::f64::consts::TAU;

#[test]
fn counts_are_the_floor_of_the_angle_and_show_faults() {
    let mut world = moving(&perfect(), 0.37, 0.0);
    run(&mut world, Actuation::Release, 1.0);
    let counts = (3.7 / TAU * 4096.0_f64).floor() as i32;
    assert_eq!(world.counts().expect("read").right, counts);
    world.inject(PlantFault::EncoderStuck(Side::Right));
    world.inject(PlantFault::EncoderReversed(Side::Left));
    run(&mut world, Actuation::Release, 1.0);
    let twice = (7.4 / TAU * 4096.0_f64).floor() as i32;
    let read = world.counts().expect("read");
    assert_eq!((read.right, read.left), (counts, counts - (twice - counts)));
    world.inject(PlantFault::EncoderFails);
    assert!(world.counts().is_err());
}

fn source() -> PoseSourceParams {
    PoseSourceParams {
        rate_hz: 40.0,
        latency_s: 0.053,
        noise_m: 0.0,
        noise_rad: 0.0,
        drop_probability: 0.0,
        bias_m: [0.0; 2],
        bias_rad: 0.0,
    }
}

#[test]
fn a_pose_is_of_the_moment_that_its_age_says() {
    let mut params = perfect();
    params.pose_source = Some(source());
    let mut world = moving(&params, 1.0, 0.0);
    let mut fixes = 0;
    for tick in 1..=100 {
        run(&mut world, Actuation::Release, 0.01);
        if let Some((pose, age_s)) = world.fix() {
            fixes += 1;
            let taken = 0.025 * f64::from(fixes);
            assert!((pose.x - taken).abs() < 1.0e-12, "{pose:?} {taken}");
            assert!((0.01 * f64::from(tick) - age_s - taken).abs() < 1.0e-12);
            assert!((0.053..0.063).contains(&age_s));
        }
    }
    // Taken at 25 ms steps up to 0.947 s.
    assert_eq!(fixes, 37);
}

#[test]
fn noise_has_its_statistics() {
    let mut params = perfect();
    params.pose_source = Some(PoseSourceParams {
        rate_hz: 100.0,
        latency_s: 0.0,
        noise_m: 0.01,
        drop_probability: 0.2,
        bias_m: [0.1, 0.0],
        ..source()
    });
    let mut world = at_rest(&params);
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for _ in 0..20_000 {
        run(&mut world, Actuation::Release, 0.01);
        if let Some((pose, _)) = world.fix() {
            count += 1.0;
            sum += pose.x - 0.1;
            squares += (pose.x - 0.1).powi(2);
        }
    }
    // Four standard deviations of each estimate from 16,000 samples.
    let n: f64 = count;
    assert!((n - 16_000.0).abs() < 4.0 * (20_000.0_f64 * 0.16).sqrt());
    assert!((sum / n).abs() < 4.0 * 0.01 / n.sqrt());
    assert!(((squares / n).sqrt() / 0.01 - 1.0).abs() < 4.0 / (2.0 * n).sqrt());
}

/// Everything that a run gives, as bits.
fn bits(keys: &WorldKeys, seed: u64) -> Vec<u64> {
    let params = keys.params(&robot());
    let mut world = World::new(&params, &Measured::default(), seed).expect("a plant");
    let mut bits = Vec::new();
    for tick in 0..200 {
        let dt_us = world.next_tick_us(TICK_US);
        world
            .advance(&duty(0.3 * (0.05 * f64::from(tick)).sin()), dt_us)
            .expect("a command");
        let Measured { pose, twist } = world.truth();
        let fix = world
            .fix()
            .map_or([0.0; 4], |(p, age)| [p.x, p.y, p.theta, age]);
        bits.push(u64::from(dt_us));
        bits.extend([pose.x, pose.y, pose.theta, twist.linear, twist.angular].map(f64::to_bits));
        bits.extend(fix.map(f64::to_bits));
        bits.push(world.currents()[0].to_bits());
    }
    bits
}

#[test]
fn a_seed_is_a_run_on_any_number_of_threads() {
    let keys = presets::lab_10kg();
    let alone: Vec<_> = (0..8).map(|seed| bits(&keys, seed)).collect();
    let together: Vec<_> = std::thread::scope(|scope| {
        let keys = &keys;
        let runs: Vec<_> = (0..8)
            .map(|seed| scope.spawn(move || bits(keys, seed)))
            .collect();
        runs.into_iter()
            .map(|run| run.join().expect("a run"))
            .collect()
    });
    assert_eq!(alone, together);
    assert!(alone.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn each_noise_has_its_own_stream() {
    let keys = presets::lab_10kg();
    let mut quiet = keys.clone();
    quiet.noise.current_a = 0.0;
    let (with, without) = (bits(&keys, 5), bits(&quiet, 5));
    for (row, other) in with.chunks(11).zip(without.chunks(11)) {
        assert_eq!(row[..10], other[..10]);
        assert_ne!(row[10], other[10]);
    }
}

#[test]
fn a_late_tick_comes_once() {
    let mut world = at_rest(&perfect());
    world.inject(PlantFault::LateTick { us: 700 });
    assert_eq!(world.next_tick_us(TICK_US), 10_700);
    assert_eq!(world.next_tick_us(TICK_US), 10_000);
}

#[test]
fn a_wrong_key_is_named() {
    assert!(toml::from_str::<WorldKeys>("[floor]\nmoo = 1.0").is_err());
    let keys: WorldKeys = toml::from_str("[[floor.patch]]\nmu = -1.0").expect("keys");
    let error = World::new(&keys.params(&robot()), &Measured::default(), 0).expect_err("a range");
    assert_eq!(error.key, "floor.patch[0].mu");
}
