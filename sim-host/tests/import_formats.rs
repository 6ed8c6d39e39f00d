//! Fixture files of every format become references that are continuous and consistent.

use sim_host::drive::{Retiming, fitted};
use sim_host::import::{FileVerdict, Fix, Format, Options, Trajectory, import};
use sim_host::mission::BaseSpec;
use std::error::Error;
use tests::fixtures::{self, DRIVABLE};

type Outcome = Result<(), Box<dyn Error>>;

fn load(name: &str) -> Result<Trajectory, Box<dyn Error>> {
    Ok(import(&fixtures::read(name)?, &Options::default())?)
}

/// What a drivable file is, by the end of its name.
fn format_of(name: &str) -> Format {
    match name.rsplit('.').next() {
        Some("json") => Format::WpilibJson,
        Some("traj") => Format::ChoreoTraj,
        Some("txt") => Format::TumPoses,
        _ => Format::Csv,
    }
}

/// Midpoint steps of this size drift by less than 1e-6 m in these files.
const STEP: f64 = 1e-4;

#[test]
fn pose_is_the_integral_of_twist_and_twist_of_acceleration() -> Outcome {
    for name in DRIVABLE {
        let trajectory = load(name)?;
        assert_eq!(trajectory.source(), format_of(name), "{name}");
        let steps = (trajectory.duration() / STEP).round();
        let h = trajectory.duration() / steps;
        let start = trajectory.at(0.0);
        let (mut x, mut y, mut theta) = (start.x, start.y, start.theta);
        let (mut v, mut w) = (start.v, start.w);
        for i in 0..steps as usize {
            let middle = trajectory.at((i as f64 + 0.5) * h);
            x += h * middle.v * middle.theta.cos();
            y += h * middle.v * middle.theta.sin();
            theta += h * middle.w;
            v += h * middle.a;
            w += h * middle.alpha;
            let end = trajectory.at(((i + 1) as f64 * h).min(trajectory.duration()));
            let pose = (end.x - x).hypot(end.y - y).max((end.theta - theta).abs());
            assert!(pose < 1e-5, "{name} at {:.4}: pose off by {pose:e}", end.t);
            let twist = (end.v - v).abs().max((end.w - w).abs());
            assert!(
                twist < 1e-3,
                "{name} at {:.4}: twist off by {twist:e}",
                end.t
            );
        }
    }
    Ok(())
}

#[test]
fn samples_are_finite_and_strictly_later() -> Outcome {
    for name in DRIVABLE {
        let trajectory = load(name)?;
        let mut last = -1.0;
        for s in trajectory.samples() {
            let values = [s.t, s.x, s.y, s.theta, s.v, s.w, s.a, s.alpha];
            assert!(values.iter().all(|v| v.is_finite()), "{name}: {s:?}");
            assert!(s.t > last, "{name}: {} after {last}", s.t);
            last = s.t;
        }
        assert_eq!(last, trajectory.duration(), "{name}");
    }
    Ok(())
}

#[test]
fn rest_at_both_ends_is_rest() -> Outcome {
    for name in DRIVABLE {
        if ["tum_planar.txt", "small_tum.txt", "table_bare.csv"].contains(&name) {
            continue; // These do not say.
        }
        let trajectory = load(name)?;
        for t in [0.0, trajectory.duration()] {
            let s = trajectory.at(t);
            assert!(s.v.abs() < 1e-6 && s.w.abs() < 1e-6, "{name} at {t}: {s:?}");
        }
    }
    Ok(())
}

/// From the end back to the last stand or change of direction it is the way that is driven, and before that 0; so it is at another pace.
#[test]
fn what_is_left_is_the_way_of_the_last_drive() -> Outcome {
    let mut known = 0;
    for name in DRIVABLE {
        let file = load(name)?;
        let (retimed, _) = fitted(
            &fixtures::read(name)?,
            &BaseSpec::default(),
            &Retiming::default(),
        )?;
        for run in [file, retimed] {
            let steps = (run.duration() / STEP).round();
            let h = run.duration() / steps;
            let end = run.at(run.duration());
            let rests = end.v.abs() < 1e-3 && end.w.abs() < 1e-2;
            assert!(end.left.abs() < 1e-9, "{name}: {end:?}");
            let (mut way, mut drives) = (0.0_f64, rests);
            for i in (0..steps as usize).rev() {
                let (middle, from) = (run.at((i as f64 + 0.5) * h), run.at(i as f64 * h));
                // What is left before a drive's first node, 25 ms of it at most, need not be known.
                drives &= way.abs() < 1e-3 || from.left > 0.0;
                if !drives {
                    assert_eq!(from.left, 0.0, "{name} at {}: {from:?}", from.t);
                    continue;
                }
                way += h * middle.v;
                let off = from.left - way.abs();
                assert!(off.abs() < 1e-6, "{name} at {}: {off:e}", from.t);
                // About a stand a fitted path creeps.
                let along = from.v * way.signum();
                let creeps = way.abs() < 1.1e-3;
                assert!(creeps || along > -1e-3, "{name} at {}: {from:?}", from.t);
            }
            known += usize::from(way.abs() > 0.01);
        }
    }
    // Both paces of all but those that turn on the spot or do not rest at their end.
    assert!(known > DRIVABLE.len(), "{known}");
    Ok(())
}

#[test]
fn dirt_is_listed_with_its_place() -> Outcome {
    let trajectory = load("wpilib_dirty.json")?;
    let at = |line, wanted: fn(&Fix) -> bool| {
        let found = trajectory
            .repairs()
            .iter()
            .find(|r| r.place.line == Some(line));
        assert!(
            found.is_some_and(|r| wanted(&r.what)),
            "line {line}: {found:?}"
        );
    };
    at(
        2,
        |fix| matches!(fix, Fix::CurvatureIgnored(k) if *k == 1e12),
    );
    at(22, |fix| *fix == Fix::ValueIgnored);
    at(74, |fix| matches!(fix, Fix::CurvatureIgnored(_)));
    at(75, |fix| *fix == Fix::DroppedRepeat);
    at(76, |fix| *fix == Fix::SharedKnot);
    assert_eq!(trajectory.repairs().len(), 5);
    Ok(())
}

#[test]
fn reversal_and_turn_through_pi_are_kept() -> Outcome {
    let trajectory = load("wpilib_dirty.json")?;
    let figures = trajectory.figures();
    assert!((figures.speed_m_s.0 - 0.8).abs() < 0.02 && (figures.speed_m_s.1 + 0.6).abs() < 0.02);
    // 2.4 rad at the start and the integral of the turn rate from there: beyond π, not wrapped.
    assert!((trajectory.at(trajectory.duration()).theta - 4.985).abs() < 1e-4);
    assert!(figures.accel < 1.0, "{figures:?}");
    Ok(())
}

#[test]
fn spin_of_three_turns_keeps_count() -> Outcome {
    let trajectory = load("table_spin.csv")?;
    let end = trajectory.at(trajectory.duration());
    assert!((end.theta - 21.0).abs() < 1e-3, "{end:?}");
    assert!(trajectory.figures().length_m < 1e-6);
    Ok(())
}

#[test]
fn shifted_columns_are_found_and_change_nothing() -> Outcome {
    let (good, shifted) = (load("choreo_v1.traj")?, load("choreo_shifted.traj")?);
    let columns: Vec<_> = shifted
        .repairs()
        .iter()
        .filter_map(|r| match r.what {
            Fix::ColumnContradicts { column, .. } => Some(column),
            _ => None,
        })
        .collect();
    assert_eq!(columns, ["omega", "al", "ar", "fl, fr"]);
    for t in [0.0, 1.0, 3.3, 6.0] {
        let (a, b) = (good.at(t), shifted.at(t));
        assert!((a.x - b.x).hypot(a.y - b.y) < 1e-9 && (a.v - b.v).abs() < 1e-9);
    }
    let derived = |name: &str| -> Result<_, Box<dyn Error>> {
        let found = load(name)?;
        Ok(found.repairs().first().map(|r| r.what))
    };
    let from = |from| {
        Some(Fix::ColumnDerived {
            column: "omega",
            from,
        })
    };
    assert_eq!(derived("choreo_v0.traj")?, from("the headings"));
    assert_eq!(
        derived("choreo_v0_track.traj")?,
        from("vl, vr and the track width")
    );
    Ok(())
}

/// The same drive as WPILib writes it since 2027: velocities in the frame of the field change nothing, and those that
/// contradict the poses are not used.
#[test]
fn samples_of_2027_are_the_same_reference() -> Outcome {
    let (choreo, wpilib) = (load("choreo_v1.traj")?, load("wpilib_2027.json")?);
    let what = |of: &Trajectory| of.repairs().iter().map(|r| r.what).collect::<Vec<_>>();
    assert_eq!(what(&wpilib), what(&choreo));
    assert!((wpilib.duration() - choreo.duration()).abs() < 1e-9);
    for i in 0..=100 {
        let t = 0.01 * f64::from(i) * choreo.duration();
        let (a, b) = (choreo.at(t), wpilib.at(t));
        // The file has six decimals.
        assert!((a.x - b.x).hypot(a.y - b.y) < 1e-5, "{t}");
        assert!((a.v - b.v).abs() < 1e-3, "{t}: {} and {}", a.v, b.v);
    }
    let doubled = String::from_utf8(fixtures::read("wpilib_2027.json")?)?
        .replace("\"leftVelocity\":", "\"leftVelocity\":3");
    let doubled = import(doubled.as_bytes(), &Options::default())?;
    assert!(
        doubled
            .repairs()
            .iter()
            .any(|repair| matches!(repair.what, Fix::ColumnContradicts { .. })),
        "{:?}",
        doubled.repairs()
    );
    Ok(())
}

/// A table from rest to rest, 2 m in 8 s and no faster than 0.47 m/s: its columns are used if its poses bear them out.
#[test]
fn columns_of_a_table_that_contradict_its_poses_are_not_used() -> Outcome {
    let contradicting = |noise: f64, stated: fn(f64) -> [f64; 2]| {
        let mut text = "t,x,y,theta,v,w\n".to_owned();
        for i in 0..=200_u32 {
            let u = f64::from(i) / 200.0;
            let x = 2.0 * u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
            let off = if i % 2 == 0 { noise } else { -noise };
            let [v, w] = stated(7.5 * (u * (1.0 - u)).powi(2));
            text += &format!("{},{},{off},0,{v},{w}\n", 8.0 * u, x + off);
        }
        let options = Options {
            tube_m: Some(0.05),
            ..Options::default()
        };
        let read = import(text.as_bytes(), &options)?;
        let columns = read
            .repairs()
            .iter()
            .filter_map(|repair| match repair.what {
                Fix::ColumnContradicts { column, .. } => Some(column),
                _ => None,
            });
        Ok::<_, Box<dyn Error>>(columns.collect::<Vec<_>>())
    };
    assert!(contradicting(0.0, |v| [v, 0.0])?.is_empty());
    assert_eq!(contradicting(0.0, |_| [5.0, 0.0])?, ["v"]);
    assert_eq!(contradicting(0.0, |v| [v, 1.0])?, ["w"]);
    assert_eq!(contradicting(0.0, |_| [-0.3, 1.0])?, ["v", "w"]);
    // Of a localiser, 0.25 m/s to and fro from pose to pose.
    assert!(contradicting(5.0e-3, |v| [v, 0.0])?.is_empty());
    assert_eq!(contradicting(5.0e-3, |_| [5.0, 0.0])?, ["v"]);
    Ok(())
}

/// Lines end in LF, CR LF or, of old programs, CR, also after a comment; they are counted alike.
#[test]
fn line_ends_make_no_difference() -> Outcome {
    for name in ["table_bare.csv", "tum_planar.txt"] {
        let text = String::from_utf8(fixtures::read(name)?)?.replace("\r\n", "\n");
        let text = format!("# a recording\n{text}");
        let options = Options::default();
        let read = import(text.as_bytes(), &options)?;
        let bad = format!("{text}# the end\nthen\n");
        let refused = import(bad.as_bytes(), &options).expect_err("refused");
        // A comment may be indented, or the last, without the end of its line.
        let indented = format!("  \n\t # it\n{text}  # ends");
        let indented = import(indented.as_bytes(), &options)?;
        assert_eq!(indented.samples(), read.samples(), "{name}");
        let last = import(format!("{text}# the end").as_bytes(), &options)?;
        assert_eq!(last.samples(), read.samples(), "{name}");
        for end in ["\r\n", "\r"] {
            let other = import(text.replace('\n', end).as_bytes(), &options)?;
            assert_eq!(other.samples(), read.samples(), "{name} {end:?}");
            let other = import(bad.replace('\n', end).as_bytes(), &options);
            assert_eq!(other.expect_err("refused"), refused, "{name} {end:?}");
        }
    }
    Ok(())
}

#[test]
fn first_and_last_pose_are_met() -> Outcome {
    let trajectory = load("table.csv")?;
    let (start, end) = (trajectory.at(0.0), trajectory.at(trajectory.duration()));
    assert!(start.x.hypot(start.y) < 1e-6 && start.theta.abs() < 1e-6);
    assert!((end.x + 0.213446).hypot(end.y - 0.809798) < 1e-6 && end.theta.abs() < 1e-6);
    Ok(())
}

#[test]
fn time_outside_is_standstill_at_the_ends() -> Outcome {
    let trajectory = load("small_tum.txt")?;
    let end = trajectory.at(trajectory.duration());
    for (t, at) in [(-1.0, trajectory.at(0.0)), (99.0, end)] {
        let s = trajectory.at(t);
        assert_eq!((s.x, s.y, s.theta), (at.x, at.y, at.theta));
        assert_eq!([s.v, s.w, s.a, s.alpha], [0.0; 4]);
    }
    Ok(())
}

/// A file that moves at its ends and states no speeds is run from rest to rest, which is said at both; one that states them is not, and
/// nor is one that only trembles there.
#[test]
fn ends_that_are_brought_to_rest_are_listed() -> Outcome {
    let line = |states: bool, speed: f64| {
        let mut text = String::from(if states {
            "t,x,y,theta,v,w\n"
        } else {
            "t,x,y,theta\n"
        });
        for i in 0..=20 {
            let t = 0.1 * f64::from(i);
            text += &format!("{t},{},0,0", speed * t);
            text += &if states {
                format!(",{speed},0\n")
            } else {
                "\n".to_owned()
            };
        }
        text
    };
    let options = Options {
        rests: true,
        ..Options::default()
    };
    for (states, speed, listed) in [(false, 0.5, 2), (true, 0.5, 0), (false, 0.05, 0)] {
        let read = import(line(states, speed).as_bytes(), &options)?;
        let ends = read.repairs().iter().filter(|repair| {
            matches!(repair.what, Fix::AtRest { speed: found, turn_rate } if (found - speed).abs() < 0.05 && turn_rate.abs() < 0.01)
        });
        assert_eq!(
            ends.count(),
            listed,
            "{states}, {speed}: {:?}",
            read.repairs()
        );
    }
    Ok(())
}

#[test]
fn verdict_reads_well() -> Outcome {
    let judged = |file: &str| {
        let read = import(file.as_bytes(), &Options::default());
        FileVerdict(read.as_ref()).to_string()
    };
    let text = judged("t,x,y,theta,v\n0,0,0,0,0\n1,0.5,0,0,1\n2,1,0,0,0\n");
    for part in ["CSV", "drivable", "2.000 s", "1.000 m", "repairs    none"] {
        assert!(text.contains(part), "{part} not in {text}");
    }
    assert!(judged("").starts_with("verdict    refused\n"));
    Ok(())
}
