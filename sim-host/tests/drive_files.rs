//! Trajectory files from end to end: run, parked, within limits; refused with place and reason.

use controller_core::motion::{Limits, MotionGains};
use sim_host::advice::{longest_period_s, period_warning};
use sim_host::drive::{ChipTable, DriveMetrics, FileRun, Retiming, fitted, trajectory};
use sim_host::import::{Options, Pace, import};
use sim_host::mission::{BaseSpec, Mission};
use sim_host::precision::Precision;
use sim_host::run::drive;
use sim_host::scenario::{BASES, BuiltInBase, MISSIONS, Scenario};
use sim_host::trials::{Condition, setup};
use std::error::Error;
use std::fs;
use std::path::Path;
use tests::fixtures::{self, DRIVABLE};
use tests::stated::{At, Stated};

fn metrics(name: &str, run: &FileRun, base: &BaseSpec) -> Result<DriveMetrics, Box<dyn Error>> {
    let (mission, scaling) = run.mission(name, &fixtures::read(name)?, base)?;
    assert!(scaling.load <= 1.0, "{name}: {scaling}");
    let trace = drive(&mission)?;
    Ok(DriveMetrics::of(&mission, &trace).ok_or("no rows")?)
}

/// Parked, exactly, and no limit passed.
fn assert_parked(name: &str, metrics: &DriveMetrics) {
    assert_eq!(metrics.outcome, "parked", "{name}: {metrics:?}");
    let last = &metrics.run.final_error;
    assert!(last.position_m < 1e-3, "{name}: {last:?}");
    assert!(last.e_theta_rad.abs() < 2e-3, "{name}: {last:?}");
    for used in &metrics.limits {
        assert!(used.peak <= used.limit * (1.0 + 1e-6), "{name}: {used:?}");
    }
}

#[test]
fn every_format_is_driven_to_parked() -> Result<(), Box<dyn Error>> {
    for name in DRIVABLE {
        let metrics = metrics(name, &FileRun::default(), &BaseSpec::default())?;
        assert_parked(name, &metrics);
    }
    Ok(())
}

/// How near a reference passes the poses of its file, and what of a base it may use.
#[test]
fn references_are_as_the_document_says() -> Result<(), Box<dyn Error>> {
    let mut page = Stated::of("docs/trajectories.md");
    let (mut planned, mut recorded) = ([0.0_f64; 2], [0.0_f64; 2]);
    for name in DRIVABLE {
        let trajectory = import(&fixtures::read(name)?, &Options::default())?;
        let off = trajectory.closeness();
        let most = if name.contains("tum") {
            &mut recorded
        } else {
            &mut planned
        };
        most[0] = most[0].max(1e3 * off.position_m);
        most[1] = most[1].max(1e3 * off.heading_rad);
    }
    page.at_most(
        At::Phrase("passes planned poses within # mm and # mrad"),
        &planned,
    );
    page.at_most(
        At::Phrase("(recorded ones within # mm and # mrad)"),
        &recorded,
    );
    let base = BaseSpec::default();
    let (limits, may) = (&base.limits, base.reference_limits());
    page.exactly(
        At::Phrase(
            "may use # % of the base's speed, # % of its acceleration, # % of its torque and jerk, and # % of its \
             angular",
        ),
        &[
            1e2 * may.max_speed / limits.speed,
            1e2 * may.max_accel / limits.accel,
            1e2 * may.max_jerk / limits.jerk,
            1e2 * may.max_angular_accel / limits.turn_accel,
        ],
    );
    Ok(())
}

/// What a heavy base takes for files, and how close the three bases keep to their references.
#[test]
fn files_take_the_time_that_the_document_says() -> Result<(), Box<dyn Error>> {
    let mut page = Stated::of("docs/trajectories.md");
    let bases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bases");
    let mut most: f64 = 0.0;
    for name in ["wpilib_dirty.json", "choreo_v1.traj", "table.csv"] {
        let bytes = fixtures::read(name)?;
        let mut figures = vec![trajectory(&bytes, &Retiming::default())?.duration()];
        for (pace, tolerance_m) in [(Pace::Own, 0.0), (Pace::Own, 0.01), (Pace::Fastest, 0.01)] {
            let retiming = Retiming { pace, tolerance_m };
            for file in ["paper-30kg.toml", "lab-10kg.toml", "hobby-1kg.toml"] {
                let base = BaseSpec {
                    hardware: None,
                    ..BaseSpec::load(&bases.join(file))?
                };
                let run = FileRun {
                    offset_m: Some(0.0),
                    retiming,
                    ..FileRun::default()
                };
                let (mission, scaling) = run.mission(name, &bytes, &base)?;
                assert!(scaling.load <= 1.0, "{name}: {scaling}");
                if file == "paper-30kg.toml" {
                    figures.push(fitted(&bytes, &base, &retiming)?.0.duration());
                }
                let metrics = DriveMetrics::of(&mission, &drive(&mission)?).ok_or("no rows")?;
                assert_parked(name, &metrics);
                let tracking = metrics.tracking.ok_or(name)?;
                most = most.max(1e3 * tracking.rms_m);
            }
        }
        page.to_a_digit(At::Row("Time", &format!("`{name}`")), &figures);
    }
    page.at_most(At::Phrase("keep these references within # mm RMS"), &[most]);
    Ok(())
}

#[test]
fn clean_files_are_tracked_within_millimetres() -> Result<(), Box<dyn Error>> {
    for name in [
        "wpilib_gaps.json",
        "choreo_v1.traj",
        "table.csv",
        "small_wpilib.json",
        "wpilib_2027.json",
    ] {
        for precision in [Precision::F32, Precision::F64] {
            let run = FileRun {
                precision,
                ..FileRun::default()
            };
            let metrics = metrics(name, &run, &BaseSpec::default())?;
            let tracking = metrics.tracking.ok_or(name)?;
            assert!(
                tracking.rms_m < 5e-3 && tracking.peak_m < 2e-2,
                "{name}: {tracking:?}"
            );
            let hand_over = metrics.run.hand_over.ok_or(name)?;
            assert!(hand_over.overshoot_m < 1e-3, "{name}: {hand_over:?}");
            assert!(metrics.run.start_torque_step.force_n == 0.0, "{name}");
        }
    }
    Ok(())
}

#[test]
fn any_side_and_any_base() -> Result<(), Box<dyn Error>> {
    let bases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bases");
    for file in ["paper-30kg.toml", "lab-10kg.toml", "hobby-1kg.toml"] {
        let base = BaseSpec::load(&bases.join(file))?;
        for offset in [-0.3, 0.0, 0.3] {
            let run = FileRun {
                offset_m: Some(offset),
                ..FileRun::default()
            };
            assert_parked(file, &metrics("choreo_v1.traj", &run, &base)?);
        }
    }
    // The default base is the same without hardware, for ideal torques on wheels that never slip.
    let file = BaseSpec::load(&bases.join("paper-30kg.toml"))?;
    let limits = Limits {
        turn_accel: 3.0,
        ..file.limits
    };
    let ideal = BaseSpec {
        limits,
        gains: None,
        hardware: None,
        ..file
    };
    assert_eq!(ideal, BaseSpec::default());
    Ok(())
}

#[test]
fn two_kilometres_from_the_origin_single_precision_parks_as_well() -> Result<(), Box<dyn Error>> {
    let line = |x_m: f64, y_m: f64| {
        let rows = (0..=40).map(|i| {
            let s = f64::from(i) / 40.0;
            let x = 2.0 * s * s * (3.0 - 2.0 * s);
            format!("{},{},{y_m},0\n", 10.0 * s, x_m + x)
        });
        format!("t,x,y,theta\n{}", rows.collect::<String>())
    };
    let base = BASES[1].base()?;
    let (mut mission, _) =
        FileRun::default().mission("far", line(1998.0, -2000.0).as_bytes(), &base)?;
    let metrics = DriveMetrics::of(&mission, &drive(&mission)?).ok_or("no rows")?;
    assert_parked("far", &metrics);
    // Farther, as in UTM metres, no file is driven, and nothing in a world.
    let utm = line(500_000.0, 5_400_000.0);
    let told = FileRun::default().mission("utm", utm.as_bytes(), &base);
    let told = told.expect_err("far from the origin").to_string();
    mission.start.pose.x = 500_000.0;
    mission.setup = Some(setup(&base, Condition::Drawn, 1));
    let start = drive(&mission).expect_err("far from the origin");
    for told in [told, start.to_string()] {
        assert!(told.contains("more than 2000 m from the origin"), "{told}");
    }
    Ok(())
}

#[test]
fn options_out_of_range_are_named() -> Result<(), Box<dyn Error>> {
    let bytes = fixtures::read("table.csv")?;
    for (run, name) in [
        (
            FileRun {
                offset_m: Some(f64::NAN),
                ..FileRun::default()
            },
            "offset",
        ),
        (
            FileRun {
                period_s: 0.0,
                ..FileRun::default()
            },
            "period",
        ),
        (
            FileRun {
                period_s: f64::INFINITY,
                ..FileRun::default()
            },
            "period",
        ),
    ] {
        let error = run
            .mission("x", &bytes, &BaseSpec::default())
            .err()
            .ok_or(name)?;
        assert!(error.to_string().starts_with(name), "{error}");
    }
    Ok(())
}

/// A run that no small machine has the memory for is told alike, of a trajectory and of a scenario.
#[test]
fn runs_have_a_longest_length() -> Result<(), Box<dyn Error>> {
    let rows = (0..8).map(|k| format!("{},{k},0,0\n", 25 * k));
    let file = format!("t,x,y,theta\n{}", rows.collect::<String>());
    let run = FileRun {
        period_s: 1.0e-4,
        ..FileRun::default()
    };
    let followed = run.mission("x", file.as_bytes(), &BaseSpec::default());
    let text = "[run]\nduration = 235\nperiod = 1e-4\n[reference]\nv = 0.1\n";
    let scenario = Scenario::parse("m.toml", text).err().ok_or("taken")?;
    let told = |periods: u32| {
        format!("is {periods} control periods; at most 2000000 are kept: choose a longer period")
    };
    assert_eq!(scenario.message, told(2_350_000));
    let followed = followed.err().ok_or("taken")?.to_string();
    // A file that states no speeds begins and ends at rest, which takes 2 ms at either end at its pace of 0.04 m/s.
    assert_eq!(followed, format!("the run {}", told(2_350_040)));
    Ok(())
}

#[test]
fn bases_are_refused_with_line_and_key() -> Result<(), Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bases/lab-10kg.toml");
    let good = fs::read_to_string(path)?;
    for (from, to, key) in [
        ("m = 10.0", "m = -1.0", "robot.m"),
        ("r = 0.075", "r = 1e9", "robot.r"),
        ("l = 0.35", "l = 0.35\ncolour = 3", "robot.colour"),
        ("speed = 1.2", "speed = nan", "limits.speed"),
        // The motors turn the wheels at 1.54 m/s without load, which is 8.8 rad/s on this track.
        ("speed = 1.2", "speed = 1.6", "limits.speed"),
        (
            "speed = 1.2",
            "speed = 1.2\nrim_speed = 1.6",
            "limits.rim_speed",
        ),
        ("turn_rate = 3.0", "turn_rate = 9.0", "limits.turn_rate"),
        ("jerk = 20.0", "", "limits.jerk"),
        (
            "wheel_torque = 2.0",
            "wheel_torque = 0",
            "limits.wheel_torque",
        ),
        // A base remembers its way for 31 ticks of 10 ms, and poses may be half as old again, and a tick.
        (
            "latency_s = 0.02",
            "latency_s = 0.201",
            "pose_source.latency_s",
        ),
        ("rate_hz = 20.0", "rate_hz = 0.0", "pose_source.rate_hz"),
        ("noise_m = 0.005", "noise_m = 0.0", "pose_source.noise_m"),
        (
            "noise_rad = 0.005",
            "noise_rad = -1.0",
            "pose_source.noise_rad",
        ),
        (
            "kt_nm_per_a = 0.045",
            "kt_nm_per_a = 0.0",
            "motor.kt_nm_per_a",
        ),
        // What the plant takes, but not the core.
        (
            "gear_efficiency = 0.8",
            "gear_efficiency = 0.1",
            "motor.gear_efficiency",
        ),
        ("nominal_v = 24.0", "nominal_v = 0.5", "battery.nominal_v"),
        ("coulomb_nm = ", "coulomb_nm = -", "friction.coulomb_nm"),
        // The core's names of gains are others.
        ("[gains]", "[gains]\nslow = -1.0", "gains.slow"),
        ("\nheading = ", "\nheading = -", "gains.heading"),
        ("\nlateral = ", "\nlateral = -", "gains.lateral"),
        ("\napproach = ", "\napproach = -", "gains.approach"),
    ] {
        let text = good.replacen(from, to, 1);
        let error = BaseSpec::parse("b.toml", &text).err().ok_or(key)?;
        assert_eq!(error.key, key, "{error}");
        assert!(error.line.is_some(), "{error}");
    }
    // Drivers with a speed loop, around known motors and around unknown ones.
    let driven = format!("{good}\n[speed_driver]\nmax_speed_rad_s = 20.0\nlag_s = 0.02\n");
    for (from, to, key) in [
        ("lag_s = 0.02", "lag_s = 1.5", "speed_driver.lag_s"),
        (
            "max_speed_rad_s = 20.0",
            "max_speed_rad_s = 0.0",
            "speed_driver.max_speed_rad_s",
        ),
        (
            "lag_s = 0.02",
            "lag_s = 0.02\nmin_speed_rad_s = 11.0",
            "speed_driver.min_speed_rad_s",
        ),
        // 15 rad/s on 75 mm are 1.125 m/s.
        (
            "max_speed_rad_s = 20.0",
            "max_speed_rad_s = 15.0",
            "limits.speed",
        ),
    ] {
        let text = driven.replacen(from, to, 1);
        let error = BaseSpec::parse("b.toml", &text).err().ok_or(key)?;
        assert_eq!(error.key, key, "{error}");
    }
    let mut table: toml::Table = driven.parse()?;
    table.remove("motor");
    table.remove("battery");
    let base = BaseSpec::parse("b.toml", &table.to_string())?;
    assert_eq!(base.robot_with_rotors(), base.robot, "of unknown motors");
    let driver = table
        .get_mut("speed_driver")
        .and_then(toml::Value::as_table_mut);
    driver.ok_or("a table")?.remove("max_speed_rad_s");
    let error = BaseSpec::parse("b.toml", &table.to_string())
        .err()
        .ok_or("taken")?;
    assert_eq!(error.key, "speed_driver.max_speed_rad_s", "{error}");
    table.remove("speed_driver");
    let error = BaseSpec::parse("b.toml", &table.to_string())
        .err()
        .ok_or("taken")?;
    assert!(
        error.message.contains("[motor] or a [speed_driver]"),
        "{error}"
    );
    Ok(())
}

/// With ticks of four fifths of the longest period that a base's gains take it parks, with twice as long ones it does not.
#[test]
fn a_period_too_long_for_the_gains_is_warned_of_and_runs_off() -> Result<(), Box<dyn Error>> {
    let built_in = BASES.iter().map(BuiltInBase::base);
    let mut bases = built_in.collect::<Result<Vec<_>, _>>()?;
    bases.push(BaseSpec::default());
    for base in bases {
        assert_eq!(period_warning(&base, base.period_s()), None);
        let longest_s = longest_period_s(&base);
        for (share, parks) in [(0.8, true), (2.0, false)] {
            let period_s = share * longest_s;
            assert_eq!(period_warning(&base, period_s).is_none(), parks);
            let run = FileRun {
                period_s,
                ..FileRun::default()
            };
            let found = metrics("wpilib_gaps.json", &run, &base)?;
            let parked = found.outcome == "parked";
            assert_eq!(parked, parks, "{}: {period_s} s", base.name);
        }
    }
    for mission in MISSIONS {
        let mission = Mission::parse("m.toml", mission.text)?;
        assert_eq!(period_warning(&mission.base, mission.period_s), None);
    }
    Ok(())
}

/// Gains that a file leaves out are those of its own period, whichever it gives; and poses may be as old in a loop of 1 kHz as in one of 250 Hz.
#[test]
fn a_file_is_taken_by_its_period() -> Result<(), Box<dyn Error>> {
    let shipped = fs::read_to_string("../bases/lab-10kg.toml")?;
    let gains = |period: &str, text: &str| -> Result<MotionGains<f64>, Box<dyn Error>> {
        let period = format!("period_s = {period}");
        let base = BaseSpec::parse("b.toml", &text.replacen("period_s = 0.01", &period, 1))?;
        Ok(base.motion().gains)
    };
    let (bare, _) = shipped.split_once("[gains]").ok_or("no gains")?;
    for (period, decay) in [("0.001", 20.0), ("0.01", 20.0), ("0.05", 8.0)] {
        let given = gains(period, &format!("{bare}[gains]\nlateral = 1.5\n"))?;
        assert_eq!(given.decay, decay, "{period} s");
        let follows = gains(period, bare)?;
        let expected = MotionGains {
            lateral: 1.5,
            ..follows
        };
        assert_eq!(given, expected, "{period} s");
    }
    let fast = shipped.replacen("period_s = 0.01", "period_s = 0.001", 1);
    let old = |latency: &str| fast.replacen("latency_s = 0.02", latency, 1);
    BaseSpec::parse("b.toml", &old("latency_s = 0.08"))?;
    let error = BaseSpec::parse("b.toml", &old("latency_s = 0.09")).err();
    assert_eq!(error.ok_or("taken")?.key, "pose_source.latency_s");
    Ok(())
}

#[test]
fn tables_for_a_chip_state_their_error() -> Result<(), Box<dyn Error>> {
    let table = ChipTable::of(
        "table",
        &fixtures::read("table.csv")?,
        &BaseSpec::default(),
        &Retiming::default(),
    )?;
    let samples = &table.compact.samples;
    assert!(table.compact.position_error_m < 1e-4 && samples.len() > 3);
    let rust = table.rust();
    assert!(
        rust.contains(&format!("pub static TABLE: [[f32; 9]; {}]", samples.len())),
        "{rust}"
    );
    assert!(rust.contains(&table.accuracy()), "{rust}");
    let binary = table.binary();
    assert_eq!(binary.len(), 36 * samples.len());
    let x = samples.get(1).ok_or("one sample")?.x;
    assert_eq!(binary.get(40..44), Some(&x.to_le_bytes()[..]));
    Ok(())
}

/// The route in flash is what `compile` makes of its file today.
#[test]
fn the_route_in_flash_is_the_table_of_its_file() -> Result<(), Box<dyn Error>> {
    let file = fixtures::read("wpilib_gaps.json")?;
    let table = ChipTable::of("curve", &file, &BaseSpec::default(), &Retiming::default())?.rust();
    let route = include_str!("../../firmware-demo/src/routes/curve.rs");
    let rows = |text: &str| -> Vec<String> {
        let rows = text.lines().filter(|line| line.starts_with("    ["));
        rows.map(str::to_owned).collect()
    };
    assert!(rows(route).len() > 10);
    assert_eq!(rows(route), rows(&table));
    Ok(())
}
