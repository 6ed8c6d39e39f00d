//! How much of what is driven is the substep's doing.

use crate::world_common::at_rest;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;
use sim_host::scenario::BuiltInBase;
use sim_host::world::{Actuation, FrictionParams, SUBSTEP_US, WorldKeys, WorldParams, presets};

/// Duties are drawn every so many ticks, and change steadily in between.
const TICKS_A_DRAW: usize = 20;

/// Positions \[m\] after every tick of a drive of 10 s under duties that are drawn within `range`.
fn positions(
    mut params: WorldParams,
    substep_us: u32,
    seed: u64,
    range: [f64; 2],
) -> Vec<[f64; 2]> {
    params.substep_us = substep_us;
    let mut world = at_rest(&params);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut draw = || [0, 1].map(|_| random.random_range(range[0]..range[1]));
    let (mut from, mut to) = (draw(), draw());
    let mut positions = Vec::new();
    for tick in 0..1000 {
        if tick % TICKS_A_DRAW == 0 {
            (from, to) = (to, draw());
        }
        let share = (tick % TICKS_A_DRAW) as f64 / TICKS_A_DRAW as f64;
        let [right, left] = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
        let command = Actuation::Duty { right, left };
        world.advance(&command, 10_000).expect("a command");
        let pose = world.truth().pose;
        positions.push([pose.x, pose.y]);
    }
    positions
}

/// Largest distance \[m\] between drives in substeps of `substep_us` and in such of a sixteenth.
fn error(params: &WorldParams, substep_us: u32, seed: u64, range: [f64; 2]) -> f64 {
    let drive = |us| positions(params.clone(), us, seed, range);
    let (coarse, fine) = (drive(substep_us), drive(substep_us / 16));
    let apart = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
    coarse.iter().zip(&fine).map(apart).fold(0.0, f64::max)
}

fn presets_of_bases() -> [(&'static str, WorldKeys); 3] {
    [
        ("paper-30kg", presets::paper_30kg()),
        ("lab-10kg", presets::lab_10kg()),
        ("hobby-1kg", presets::hobby_1kg()),
    ]
}

fn params(name: &str, keys: &WorldKeys) -> WorldParams {
    let base = BuiltInBase::find(name).expect("a built-in base").base();
    keys.params(&base.expect("a base").robot)
}

const AHEAD: [f64; 2] = [0.1, 0.6];
const TO_AND_FRO: [f64; 2] = [-0.9, 0.9];

#[test]
fn a_drive_of_10_s_is_good_to_a_fifth_of_a_millimetre_and_to_four_where_wheels_slip() {
    for (name, keys) in presets_of_bases() {
        let params = params(name, &keys);
        for seed in 1..=4 {
            for (range, bound) in [(AHEAD, 0.2e-3), (TO_AND_FRO, 4.0e-3)] {
                let error = error(&params, SUBSTEP_US, seed, range);
                assert!(error < bound, "{name}, {seed}, {range:?}: {error:e}");
            }
        }
    }
}

#[test]
fn substeps_are_of_second_order_but_where_something_begins_or_ends() {
    for (name, keys) in presets_of_bases() {
        let mut params = params(name, &keys);
        // Wheels neither slip nor break loose, and drivers do not limit: all that happens at an instant within a substep.
        params.floor.mu = 5.0;
        params.friction = FrictionParams::default();
        if let Some(motor) = &mut params.motor {
            motor.current_limit_a = f64::INFINITY;
        }
        for seed in 1..=2 {
            let [whole, half] =
                [SUBSTEP_US, SUBSTEP_US / 2].map(|us| error(&params, us, seed, AHEAD));
            // Second order is a quarter.
            assert!(
                half < 0.3 * whole && whole < 1.0e-5,
                "{name}, {seed}: {whole:e} {half:e}"
            );
        }
    }
}
