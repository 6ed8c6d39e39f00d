//! How fast the plant runs, for information: `cargo test --release -- --nocapture`.

use crate::world_common::*;
use controller_core::types::Measured;
use sim_host::world::{Actuation, World, presets};
use std::time::Instant;

#[test]
fn a_bad_world_runs_many_times_faster_than_time() {
    for (name, duty) in [("rolling", 0.1), ("slipping", 1.0)] {
        let mut params = presets::paper_30kg().params(&robot());
        if name == "slipping" {
            params.floor.mu = 0.05;
        }
        let mut world = World::new(&params, &Measured::default(), 3).expect("a plant");
        let seconds = 40.0;
        let start = Instant::now();
        let mut slips = 0;
        for tick in 0..(seconds * 100.0) as u32 {
            let sign = if tick / 100 % 2 == 0 { 1.0 } else { -1.0 };
            let command = Actuation::Duty {
                right: sign * duty,
                left: 0.5 * sign * duty,
            };
            world.advance(&command, TICK_US).expect("a command");
            slips += usize::from(world.slipping() != [false; 2]);
        }
        let factor = seconds / start.elapsed().as_secs_f64();
        println!(
            "{name}: {factor:.0} times real time, {slips} ticks of slip; {:?}",
            world.truth()
        );
        // Far below what any machine does optimised, so that a busy one does not fail.
        assert!(factor > 5.0);
        assert!((name == "slipping") == (slips > 2000));
    }
}
