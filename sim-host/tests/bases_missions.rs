//! Every scenario with the law for a real base, driven by each of the example robots as far as its limits
//! allow: on the ideal plant, and the bad floors on a bad floor.

use controller_core::motion::Outcome;
use sim_host::mission::{BaseSpec, Course, Mission, Route};
use sim_host::run::drive;
use sim_host::scenario::{BASES, MISSIONS};
use std::error::Error;

/// A scenario on another base; none if its reference is faster than the base, with a tenth for feedback.
fn mission(name: &str, text: &str, base: &BaseSpec) -> Result<Option<Mission>, Box<dyn Error>> {
    let mut mission = Mission::parse(&format!("{name}.toml"), text)?;
    if let Course::Follow {
        route: Route::Motion(motion),
        ..
    } = &mission.course
        && motion.largest_speed() > 0.9 * base.limits.speed
    {
        return Ok(None);
    }
    mission.base = base.clone();
    mission.robot = base.robot;
    if let Some(setup) = &mut mission.setup {
        let hardware = base.hardware.ok_or("no hardware")?;
        setup.world.battery = hardware.battery;
        setup.world.battery.open_circuit_v = Some(0.9 * hardware.battery.nominal_v);
        mission.period_s = base.period_s();
    }
    Ok(Some(mission))
}

#[test]
fn all_robots_do_all_scenarios() -> Result<(), Box<dyn Error>> {
    let mut failed = Vec::new();
    let mut done = 0;
    for built_in in BASES {
        let base = built_in.base()?;
        for scenario in MISSIONS {
            let Some(mission) = mission(scenario.name, scenario.text, &base)? else {
                continue;
            };
            let trace = drive(&mission)?;
            let last = trace.rows.last().ok_or("no rows")?;
            let (distance, heading) = (last.error.x.hypot(last.error.y), last.error.theta.abs());
            // On the ideal plant within half a millimetre and 0.9 mrad; on a floor as `verify` asks.
            let (mm, mrad) = match mission.setup {
                Some(_) => (5.0, 10.0),
                None => (0.5, 0.9),
            };
            let what = format!("{} {}", built_in.name, scenario.name);
            println!(
                "{what}: {:?} at {:.1} s, {:.3} mm, {:.3} mrad",
                last.report.outcome,
                last.t,
                1e3 * distance,
                1e3 * heading
            );
            done += 1;
            let parked = last.report.outcome == Outcome::Parked;
            if !parked || 1e3 * distance > mm || 1e3 * heading > mrad {
                failed.push(what);
            }
        }
    }
    // All but `fast`, 2 m/s, on the two slower robots.
    assert_eq!(done, BASES.len() * MISSIONS.len() - 2);
    assert!(failed.is_empty(), "{failed:?}");
    Ok(())
}
