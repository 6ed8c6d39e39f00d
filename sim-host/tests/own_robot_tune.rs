//! Gains that were set wrong are found again.

use controller_core::motion::MotionGains;
use rand::SeedableRng;
use rand_distr::{Distribution, LogNormal};
use rand_pcg::Pcg64Mcg;
use sim_host::drive::Base;
use sim_host::scenario::BuiltInBase;
use sim_host::tune::{KNOBS, Search, Tuned, Wish, search};
use std::error::Error;

/// Small enough for a test: a first look at 24 sets and one simplex.
const SEARCH: Search = Search {
    evaluations: 72,
    starts: 1,
    training: 4,
    unseen: 8,
    seed: 1,
};

/// The hobby base with gains that `detune` spoils by a factor for each knob.
fn tuned(detune: impl FnMut(&str) -> f64) -> Result<Tuned, Box<dyn Error>> {
    let mut base: Base = BuiltInBase::find("hobby-1kg")
        .ok_or("not built in")?
        .base()?;
    let mut gains: MotionGains<f64> = base.motion().gains;
    let mut detune = detune;
    for knob in KNOBS {
        let value = knob.of(&gains);
        knob.put(&mut gains, detune(knob.key) * value);
    }
    base.gains = Some(gains);
    Ok(search(&Wish::courses(&base), &SEARCH, || {})?)
}

/// So much fewer points, as a share of those before, where the search did not look.
fn is_better(what: &str, tuned: &Tuned, unseen: f64) {
    let [before, after] = tuned.unseen;
    println!(
        "{what}: {:.2} to {:.2} points, training {:.2} to {:.2}",
        before.total(),
        after.total(),
        tuned.training[0].total(),
        tuned.training[1].total()
    );
    assert!(
        after.total() <= (1.0 - unseen) * before.total(),
        "{what}: {before:?} {after:?}"
    );
}

#[test]
fn too_slow_everywhere() -> Result<(), Box<dyn Error>> {
    is_better("all x0.4", &tuned(|_| 0.4)?, 0.2);
    Ok(())
}

#[test]
fn stiff_across_on_slow_loops() -> Result<(), Box<dyn Error>> {
    let tuned = tuned(|key| match key {
        "heading" | "across" => 6.0,
        "speed_loop" | "turn_loop" => 0.3,
        _ => 1.0,
    })?;
    is_better("heading, across x6, loops x0.3", &tuned, 0.2);
    Ok(())
}

#[test]
fn drawn_at_random() -> Result<(), Box<dyn Error>> {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    // Mostly within a factor of 2.7.
    let spread = LogNormal::new(0.0, 0.5).map_err(|_| "spread")?;
    is_better("log-normal", &tuned(|_| spread.sample(&mut random))?, 0.2);
    Ok(())
}
