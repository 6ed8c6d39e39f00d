//! Poses that fail for 20 s while the base drives.

use crate::rig::{Draw, Rig, Wander, bad_floor, mission, seeds};
use controller_core::base::Order;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;
use sim_host::world::PlantFault;

/// Poses fail from here on, for so long \[s\].
const FROM_S: f64 = 10.0;
const LOST_S: f64 = 20.0;
/// Driving by velocity until then, and then to a goal \[s\].
const DRIVE_S: f64 = FROM_S + 10.0;

/// Where it parked without poses, and where it ended when they were back, off the goal \[m, rad\].
#[derive(Debug, Default)]
struct Ends {
    blind: Option<(f64, f64)>,
    last: Option<(f64, f64)>,
    way: f64,
}

fn run(base: &BaseSpec, seed: u64) -> Ends {
    let setup = bad_floor(base, seed);
    let mut queue = ReferenceQueue::new();
    let mission = mission(base);
    let mut rig = Rig::start(&mut queue, &mission, &setup);
    // Half a metre a second at most: ten metres.
    let mut slow = base.clone();
    slow.limits.speed = slow.limits.speed.min(0.8);
    slow.limits.turn_rate = slow.limits.turn_rate.min(2.0);
    let mut wander = Wander::new(&slow, seed);
    let mut draw = Draw::new(seed ^ 0x90a1);
    let mut ends = Ends::default();
    let mut goal = None;
    while rig.t < FROM_S + LOST_S + 15.0 {
        let lost = (FROM_S..FROM_S + LOST_S).contains(&rig.t);
        if lost {
            rig.base.world_mut().inject(PlantFault::PoseSilent);
        } else {
            rig.base.world_mut().heal(PlantFault::PoseSilent);
        }
        let order = if rig.t < DRIVE_S {
            wander.at(rig.t)
        } else {
            let at = rig.base.report().measured.expect("measured").pose;
            let goal = *goal.get_or_insert_with(|| {
                let bearing = f64::from(at.theta) + draw.between(-0.5, 0.5);
                let (x, y) = (0.8 * bearing.cos(), 0.8 * bearing.sin());
                Pose::new(at.x + x as f32, at.y + y as f32, bearing as f32)
            });
            Order::Park(goal)
        };
        let before = rig.world().truth().pose;
        let report = rig.tick(&order);
        let truth = rig.world().truth().pose;
        if lost {
            ends.way += (truth.x - before.x).hypot(truth.y - before.y);
        }
        if let Some(goal) = goal {
            let off = (
                (truth.x - f64::from(goal.x)).hypot(truth.y - f64::from(goal.y)),
                (truth.theta - f64::from(goal.theta)).abs(),
            );
            if report.state == State::Parked {
                if lost {
                    ends.blind = ends.blind.or(Some(off));
                }
                ends.last = Some(off);
            } else {
                ends.last = None;
            }
        }
        if !report.state.is_live() && rig.t > 1.1 {
            println!("{} {seed}: {:.3} {:?} {:?}", base.name, rig.t, report.cause, report.state);
            break;
        }
        if std::env::var("V").is_ok() && (rig.t * 200.0).round() as u64 % 200 == 0 {
            println!("  {:.2} heading {:.5} position {:.4} bias off {:.6} {:?}", rig.t, rig.heading_error(), rig.position_error(),
              f64::from(report.gyro.bias) - rig.world().gyro_bias().unwrap_or(0.0), report.fix);
        }
    }
    ends
}

#[test]
fn a_base_that_loses_its_poses_for_twenty_seconds_parks() {
    for built_in in BASES {
        let base = built_in.with_gyro().expect("valid");
        let mut ends: Vec<_> = seeds(20).map(|seed| (run(&base, seed), seed)).collect();
        for (ends, seed) in &ends {
            println!("{seed} {:.1} m {:?} {:?}", ends.way, ends.blind.map(|b| (1e3 * b.0, 1e3 * b.1)), ends.last.map(|b| (1e3 * b.0, 1e3 * b.1)));
        }
        ends.retain(|(ends, _)| ends.blind.is_some());
        let worst = ends.iter().map(|(ends, _)| ends.blind.map_or(0.0, |(m, _)| m)).fold(0.0, f64::max);
        println!("{} parked {} worst {:.1} mm", built_in.name, ends.len(), 1e3 * worst);
    }
}
