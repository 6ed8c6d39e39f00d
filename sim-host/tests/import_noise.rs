//! Recordings with noise: smoothed within the tolerance and said so, or refused with the tolerance that they need.

use sim_host::drive::{DriveMetrics, FileRun, Retiming, trajectory};
use sim_host::import::{Fix, Pace, Reason, Trajectory};
use sim_host::mission::BaseSpec;
use sim_host::run::drive;
use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write;
use tests::random::Random;
use tests::tuning_loop::{BASES, file};

/// Every 20th of a second of half a minute, as a localiser records.
const POSES: u32 = 600;
const APART_S: f64 = 0.05;
/// What nobody chose: counted from one.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;

/// An eight of 1 m by 0.5 m, from rest to rest, and its heading, `k` poses from its start.
fn eight(k: u32) -> [f64; 3] {
    let part = f64::from(k) / f64::from(POSES);
    let way = TAU * part.powi(3) * (10.0 - part * (15.0 - 6.0 * part));
    let heading = libm::atan2((2.0 * way).cos(), way.cos());
    [0.5 * way.sin(), 0.25 * (2.0 * way).sin(), heading]
}

/// Its poses with noise [m, rad], as TUM poses or as CSV.
fn recording(seed: u64, noise: [f64; 2], tum: bool) -> Result<String, std::fmt::Error> {
    let mut random = Random(seed);
    let mut text = if tum { "" } else { "t,x,y,theta\n" }.to_owned();
    for k in 0..=POSES {
        let (t, [x, y, theta]) = (APART_S * f64::from(k), eight(k));
        let (x, y) = (
            x + noise[0] * random.normal(),
            y + noise[0] * random.normal(),
        );
        let theta = theta + noise[1] * random.normal();
        if tum {
            let (sin, cos) = (0.5 * theta).sin_cos();
            writeln!(text, "{t:.2} {x:.6} {y:.6} 0 0 0 {sin:.9} {cos:.9}")?;
        } else {
            writeln!(text, "{t:.2},{x:.6},{y:.6},{theta:.6}")?;
        }
    }
    Ok(text)
}

/// How far a reference is from where the base truly was \[m\].
fn off(trajectory: &Trajectory) -> f64 {
    let pose = |k| {
        let (at, [x, y, _]) = (trajectory.at(APART_S * f64::from(k)), eight(k));
        (at.x - x).hypot(at.y - y)
    };
    (0..=POSES).map(pose).fold(0.0, f64::max)
}

/// 2 mm and 5 mrad, 20 seeds in two formats: all are taken, within the tolerance of every pose and nearer to where the base was; the
/// three bases run them no slower than they were recorded, within their limits, and park.
#[test]
fn noise_within_the_tolerance_is_smoothed() -> Result<(), Box<dyn Error>> {
    let tolerance = Retiming::default().tolerance_m;
    for seed in SEEDS {
        let text = recording(seed, [2e-3, 5e-3], seed % 2 == 0)?;
        let reference = trajectory(text.as_bytes(), &Retiming::default())?;
        let close = reference.closeness();
        assert!(close.position_m <= tolerance, "{seed}: {close:?}");
        let away = off(&reference);
        assert!(away <= tolerance, "{seed}: {away}");
        let [repair] = reference.repairs() else {
            return Err(format!("{seed}: {:?}", reference.repairs()).into());
        };
        let Fix::Noise { scatter, off } = repair.what else {
            return Err(format!("{seed}: {repair}").into());
        };
        // A deviation by the median of 600 has one of 5 % itself: three of them.
        assert!(
            (scatter.position_m / 2e-3 - 1.0).abs() < 0.15,
            "{seed}: {repair}"
        );
        assert!(
            (scatter.heading_rad / 5e-3 - 1.0).abs() < 0.15,
            "{seed}: {repair}"
        );
        assert_eq!(off, close, "{seed}");
        for base in BASES {
            let base = BaseSpec {
                hardware: None,
                ..file(base)
            };
            let (mission, scaling) =
                FileRun::default().mission("recorded", text.as_bytes(), &base)?;
            assert!(scaling.factor < 1.01, "{seed}, {}: {scaling}", base.name);
            let metrics = DriveMetrics::of(&mission, &drive(&mission)?).ok_or("no rows")?;
            assert_eq!(
                metrics.outcome, "parked",
                "{seed}, {}: {metrics:?}",
                base.name
            );
            for used in &metrics.limits {
                assert!(used.peak <= used.limit * (1.0 + 1e-6), "{seed}: {used:?}");
            }
        }
    }
    Ok(())
}

/// The same recording without noise is followed as closely as ever, and nothing is said of noise.
#[test]
fn poses_without_noise_are_followed_as_closely_as_ever() -> Result<(), Box<dyn Error>> {
    for (tum, most) in [(true, 5e-3), (false, 1e-3)] {
        let reference = trajectory(
            recording(1, [0.0; 2], tum)?.as_bytes(),
            &Retiming::default(),
        )?;
        assert!(
            reference.closeness().position_m <= most,
            "{:?}",
            reference.closeness()
        );
        assert_eq!(reference.repairs(), []);
    }
    Ok(())
}

/// 4 mm are more than the tolerance, in either format with any seed: the refusal says so, and with the tolerance that it asks for the file is taken.
#[test]
fn noise_beyond_the_tolerance_is_refused_with_the_tolerance_that_it_needs()
-> Result<(), Box<dyn Error>> {
    for seed in SEEDS {
        let text = recording(seed, [4e-3, 1e-2], seed % 2 == 0)?;
        let Err(refusal) = trajectory(text.as_bytes(), &Retiming::default()) else {
            return Err(format!("{seed}: should be refused").into());
        };
        let said = refusal.to_string();
        assert!(
            matches!(refusal.reason, Reason::Noise { .. }),
            "{seed}: {said}"
        );
        let asked = said
            .split("a tolerance of ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        let tolerance_m = asked.ok_or(said.clone())?.parse()?;
        let wider = Retiming {
            tolerance_m,
            ..Retiming::default()
        };
        let reference = trajectory(text.as_bytes(), &wider)?;
        assert!(
            reference.closeness().position_m <= tolerance_m,
            "{seed}: {said}"
        );
    }
    Ok(())
}

/// What the search for the quickest run of a noisy recording takes, in limits looked at, which no machine changes: noise moves curvature and limits at
/// every pose, so that such files take longest. A tenth more fails.
#[test]
fn searching_takes_no_more_work_than_it_did() -> Result<(), Box<dyn Error>> {
    let text = recording(1, [2e-3, 5e-3], false)?;
    let reference = trajectory(text.as_bytes(), &Retiming::default())?;
    let retiming = Retiming {
        pace: Pace::Fastest,
        ..Retiming::default()
    };
    let mut millions = Vec::new();
    for base in BASES {
        let (_, scaling) = retiming.of(&reference, &file(base))?;
        millions.push(scaling.work as f64 * 1e-6);
    }
    let mut usual = [4.9, 4.9, 9.0].into_iter();
    let no_more = |now: &f64| usual.next().is_some_and(|usual| *now < 1.1 * usual);
    assert!(millions.iter().all(no_more), "{millions:?}");
    Ok(())
}
