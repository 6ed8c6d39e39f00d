//! Scenario files with the law for a real base.

use controller_core::types::Pose;
use sim_host::drive::DriveMetrics;
use sim_host::mission::{Change, Course, Event, Mission};
use sim_host::precision::Precision;
use sim_host::run::drive;
use sim_host::scenario::{BuiltInBase, MISSIONS, Scenario};
use sim_host::trace::Trace;
use std::error::Error;
use tests::random::Random;
use tests::stated::{At, Stated};

fn run(text: &str, name: &str) -> Result<(Mission, Trace, DriveMetrics), Box<dyn Error>> {
    let mission = Mission::parse(&format!("{name}.toml"), text)?;
    let trace = drive(&mission)?;
    let metrics = DriveMetrics::of(&mission, &trace).ok_or("no rows")?;
    Ok((mission, trace, metrics))
}

#[test]
fn all_of_them_park_within_limits_and_without_jumps() -> Result<(), Box<dyn Error>> {
    let mut page = Stated::of("docs/trajectories.md");
    let (mut off, mut turned) = (0.0_f64, 0.0_f64);
    for built_in in MISSIONS {
        let name = built_in.name;
        let (mission, trace, metrics) = run(built_in.text, name)?;
        if mission.setup.is_some() {
            // Not the ideal plant: below.
            continue;
        }
        assert_eq!((metrics.outcome, mission.name.as_str()), ("parked", name));
        let last = &metrics.run.final_error;
        assert!(
            last.position_m < 1e-3 && last.e_theta_rad.abs() < 1e-3,
            "{name}: {last:?}"
        );
        off = off.max(last.position_m);
        turned = turned.max(last.e_theta_rad.abs());
        let mut times = vec![metrics.parked_s.ok_or("not parked")?];
        // When the reference rests, or the last goal comes.
        match &mission.course {
            Course::Follow {
                hand_over: Some(rule),
                ..
            } => times.push(rule.end_s),
            _ => times.extend(mission.events.last().map(|event| event.at_s)),
        }
        let row = format!("`{name}`");
        page.exactly(
            At::Cell("Scenarios for the default law", &row, "arrives"),
            &times,
        );
        for used in &metrics.limits {
            assert!(used.peak <= used.limit * (1.0 + 1e-6), "{name}: {used:?}");
        }
        let motion = mission.base.motion().validate()?;
        for pair in trace.rows.windows(2) {
            let [a, b] = pair else { continue };
            let step = b.report.wrench.force - a.report.wrench.force;
            assert!(
                step.abs() <= 1.01 * motion.force_rate_limit() * trace.period_s,
                "{name}"
            );
            let step = b.report.wrench.moment - a.report.wrench.moment;
            assert!(
                step.abs() <= 1.01 * motion.moment_rate_limit() * trace.period_s,
                "{name}"
            );
        }
    }
    page.exactly(
        At::Phrase("All end within # mm and # mrad, in single precision"),
        &[1e3 * off, 1e3 * turned],
    );
    Ok(())
}

/// The scenarios with a `[world]`: what `sim-host verify` asks, and that limits hold for what is commanded.
#[test]
fn bad_floors_are_parked_on() -> Result<(), Box<dyn Error>> {
    let mut floors = 0;
    for built_in in MISSIONS.iter().filter(|m| m.text.contains("[world")) {
        let (_, _, metrics) = run(built_in.text, built_in.name)?;
        assert_eq!((metrics.outcome, &metrics.stopped), ("parked", &None));
        let last = &metrics.run.final_error;
        assert!(
            last.position_m < 5e-3 && last.e_theta_rad.abs() < 10e-3,
            "{}: {last:?}",
            built_in.name
        );
        assert!(metrics.hand_over_distance_m.is_some());
        for used in &metrics.limits {
            assert!(used.peak <= used.limit * (1.0 + 1e-6), "{used:?}");
        }
        floors += 1;
    }
    assert_eq!(floors, 2);
    Ok(())
}

/// A run that ends before its time says why: a wall of friction from 2 s on.
#[test]
fn a_base_that_stops_says_when_and_why() -> Result<(), Box<dyn Error>> {
    let text = MISSIONS
        .iter()
        .find(|m| m.name == "bad-floor-line")
        .ok_or("not built in")?
        .text;
    let push = "[[world.push]]\ntime_s = [2.0, 60.0]\nforce_x_n = -200.0\n[world.battery]";
    let (_, trace, metrics) = run(&text.replacen("[world.battery]", push, 1), "wall")?;
    let stop = metrics.stopped.ok_or("went on")?;
    assert!(stop.time_s > 2.0 && !stop.cause.is_empty(), "{stop:?}");
    assert!(trace.rows.iter().all(|row| row.base.is_some()));
    Ok(())
}

#[test]
fn a_jump_of_the_localisation_is_a_jump_of_the_measured_pose_only() -> Result<(), Box<dyn Error>> {
    let text = MISSIONS
        .iter()
        .find(|m| m.name == "retarget")
        .ok_or("not built in")?
        .text;
    let (_, trace, _) = run(text, "retarget")?;
    let (before, after) = (&trace.rows[399], &trace.rows[400]);
    assert!((after.measured.x - before.measured.x - 0.2).abs() < 0.02);
    assert!((after.truth.pose.x - before.truth.pose.x).abs() < 0.02);
    assert!(after.report.jumped && !before.report.jumped);
    Ok(())
}

/// Until the last of three jumps the pose is wrong, by up to 0.45 m and 0.6 rad.
#[test]
fn a_pose_that_jumps_on_the_way_is_parked_by() -> Result<(), Box<dyn Error>> {
    const RUNS: u32 = 20;
    let mut page = Stated::of("docs/motion.md");
    let (mut means, mut most) = (Vec::new(), Vec::new());
    for name in ["paper-30kg", "lab-10kg", "hobby-1kg"] {
        let mut mission = Mission::parse("jumps.toml", &GOOD.replace("= 5", "= 30"))?;
        mission.base = BuiltInBase::find(name).ok_or("not built in")?.base()?;
        mission.robot = mission.base.robot;
        let mut times = Vec::new();
        for seed in 0..RUNS {
            let mut random = Random(u64::from(seed));
            let mut pose =
                |m, rad| Pose::new(random.within(m), random.within(m), random.within(rad));
            mission.course = Course::Park(pose(1.0, 2.0));
            mission.events = [0.5, 1.0, 1.5]
                .map(|at_s| Event {
                    at_s,
                    change: Change::Jump(pose(0.15, 0.2)),
                })
                .to_vec();
            let metrics = DriveMetrics::of(&mission, &drive(&mission)?).ok_or("no rows")?;
            times.push(metrics.parked_s.ok_or("not parked")?);
        }
        means.push(times.iter().sum::<f64>() / f64::from(RUNS));
        most.push(times.into_iter().fold(0.0, f64::max));
    }
    let stated = [vec![f64::from(RUNS)], means, most].concat();
    page.exactly(
        At::Phrase("# starts a base with three jumps within 1.5 s park after #, # and # s in the mean, after #, # and # s at most"),
        &stated,
    );
    Ok(())
}

const GOOD: &str = "\
[run]
duration = 5
period = 0.01
[controller]
kind = \"motion\"
[goal]
x = 1
";

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (from, to, key) in [
        ("period = 0.01", "period = 0", "run.period"),
        ("[goal]", "[goal]\nz = 1", "goal.z"),
        ("x = 1", "x = inf", "goal.x"),
        ("[goal]\nx = 1\n", "", "reference"),
        ("[goal]", "[reference]\nv = 1\n[goal]", "goal"),
        ("[goal]", "[limits]\nspeed = 1\n[goal]", "limits.turn_rate"),
        ("[goal]", "[gains]\nk1 = 1\n[goal]", "gains"),
        (
            "x = 1\n",
            "x = 1\n[[event]]\nat = 9\nfollow = true\n",
            "event[0].at",
        ),
        (
            "x = 1\n",
            "x = 1\n[[event]]\nat = 1\nfollow = true\n",
            "event[0]",
        ),
        (
            "x = 1\n",
            "x = 1\n[[event]]\nat = 1\ndrive = { v = 101 }\n",
            "event[0].drive.v",
        ),
        (
            "x = 1\n",
            "x = 1\n[[event]]\nat = 1\nfollow = true\ndrive = { v = 0.1 }\n",
            "event[0]",
        ),
        (
            "x = 1\n",
            "x = 1\n[[event]]\nat = 1\ndrive = { w = inf }\n",
            "event[0].drive.w",
        ),
        (
            "x = 1\n",
            "x = 1\n[plant]\nmass_factor = 0\n",
            "plant.mass_factor",
        ),
        (
            "[goal]\nx = 1",
            "[reference]\nv = 1\n[hand_over]\n",
            "hand_over",
        ),
    ] {
        let text = GOOD.replacen(from, to, 1);
        let error = Mission::parse("mine.toml", &text).expect_err(key);
        assert_eq!(error.key, key, "{error}");
        assert!(error.line.is_some(), "{error}");
    }
    assert!(Mission::parse("mine.toml", GOOD).is_ok());
}

/// Each error of an event names the line of that one, whichever others there are.
#[test]
fn events_are_named_one_by_one() {
    for (third, key, line, says) in [
        (
            "at = 9\njump = {}",
            "event[2].at",
            15,
            "within run.duration",
        ),
        ("at = 1\njump = {}", "event[2].at", 15, "before"),
        ("at = 3\nfollow = true", "event[2]", 14, "no [reference]"),
        ("at = 3", "event[2]", 14, "needs one of"),
        (
            "at = 3\ngoal = { y = nan }",
            "event[2].goal.y",
            16,
            "number",
        ),
        (
            "at = 3\ndrive = { v = nan }",
            "event[2].drive.v",
            16,
            "a number in -100 to 100",
        ),
    ] {
        let others = "[[event]]\nat = 1\njump = {}\n[[event]]\nat = 2\njump = {}\n";
        let text = format!("{GOOD}{others}[[event]]\n{third}\n");
        let error = Mission::parse("mine.toml", &text).expect_err(third);
        assert_eq!(
            (error.key.as_str(), error.line),
            (key, Some(line)),
            "{error}"
        );
        assert!(error.message.contains(says), "{error}");
    }
}

/// The whole base is the chip's, in single precision, and what it computes in is what the mission says.
#[test]
fn no_whole_base_computes_in_double_precision() {
    let parse = |precision: &str, world: &str| {
        let kind = format!("kind = \"motion\"\n{precision}");
        let text = GOOD.replacen("kind = \"motion\"\n", &kind, 1) + world;
        Mission::parse("mine.toml", &text)
    };
    let double = "precision = \"f64\"\n";
    let world = "[world.floor]\nmu = 0.5\n";
    let error = parse(double, world).expect_err("f64 in a world");
    assert_eq!(
        (error.key.as_str(), error.line),
        ("controller.precision", Some(6)),
        "{error}"
    );
    let computes = |mission: Result<Mission, _>| mission.map(|mission| mission.precision);
    assert_eq!(computes(parse("", world)), Ok(Precision::F32));
    assert_eq!(computes(parse(double, "")), Ok(Precision::F64));
}

/// Of a world as well, each in the one table or list where it stands.
#[test]
fn worlds_out_of_range_are_refused_with_line_and_key() {
    for (world, key, line) in [
        ("[world.floor]\nmu = -1.0", "world.floor.mu", 9),
        (
            "[world.body]\nmass_factor = -1.0",
            "world.body.mass_factor",
            9,
        ),
        (
            "[world.body]\ntrack_factor = 0.0",
            "world.body.track_factor",
            9,
        ),
        (
            "[[world.push]]\ntime_s = [1.0, 2.0]\n[[world.push]]\ntime_s = [2.0, 1.0]",
            "world.push[1].time_s",
            11,
        ),
        (
            "[world.floor]\npatch = [{ mu = 0.0, x_m = [0.0, 1.0] }]",
            "world.floor.patch[0].mu",
            9,
        ),
        ("[world]\nsubstep_us = 0", "world.substep_us", 9),
    ] {
        let error = Mission::parse("mine.toml", &format!("{GOOD}{world}\n")).expect_err(key);
        assert_eq!(
            (error.key.as_str(), error.line),
            (key, Some(line)),
            "{error}"
        );
    }
    let text = format!("{GOOD}[world.floor]\nmu = -1.0\n");
    let error = Mission::parse("mine.toml", &text).expect_err("no floor");
    assert!(
        error
            .to_string()
            .starts_with("mine.toml:9: world.floor.mu: -1 is not in 0.001 to inf\n"),
        "{error}"
    );
}

#[test]
fn the_papers_loop_does_not_take_it() {
    let error = Scenario::parse("mine.toml", GOOD).expect_err("another law");
    assert_eq!(
        (error.key.as_str(), error.line),
        ("controller.kind", Some(5))
    );
}
