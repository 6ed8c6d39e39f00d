//! Files that cannot be driven are refused with line, field and reason.

use sim_host::import::{MAX_SAMPLES, Options, Reason, Refusal, Untimed, import};
use std::error::Error;
use tests::fixtures;

/// The refusal of a file; drivable files fail the test.
fn refusal(bytes: &[u8]) -> Result<Refusal, String> {
    match import(bytes, &Options::default()) {
        Ok(_) => Err("this file should be refused".to_owned()),
        Err(refusal) => Ok(refusal),
    }
}

fn fixture(name: &str) -> Result<Refusal, Box<dyn Error>> {
    Ok(refusal(&fixtures::read(name)?)?)
}

/// Start of a CSV file and of a JSON state.
const CSV: &str = "t,x,y,theta\n0,0,0,0\n";
const STATE: &str = r#"{"time":0,"velocity":0,"acceleration":0,"curvature":0,"pose":{"translation":{"x":0,"y":0},"rotation":{"radians":0}}}"#;

#[test]
fn messages_name_line_field_and_reason() -> Result<(), String> {
    let wpilib = |second: &str| format!("[{STATE},\n\n{second}]");
    for (text, message) in [
        (String::new(), "the file: the file is empty"),
        ("hello world\n".to_owned(), "line 1: not a trajectory file"),
        (
            CSV.replace(",theta", ""),
            "line 1, field `theta`: the column is missing",
        ),
        (
            CSV.replace("theta", "phi"),
            "line 1, field `phi`: unknown column",
        ),
        (
            CSV.replace("theta", "x"),
            "line 1, field `x`: the column is there twice",
        ),
        (
            format!("{CSV}# note\n1,0.1,zero,0\n"),
            "line 4, sample 1, field `y`: `zero` is not a number",
        ),
        (
            format!("{CSV}1,0.1,inf,0\n"),
            "line 3, sample 1, field `y`: `inf` is not a number",
        ),
        (
            format!("{CSV}1,0.1,0\n"),
            "line 3: 3 values where there should be 4",
        ),
        (
            CSV.to_owned(),
            "field `samples`: too few samples (1); at least two",
        ),
        // Numbers as a file has them, without exponents.
        (
            format!("{CSV}1,0,0,0\n0.5,0,0,0\n"),
            "line 4, sample 2, field `t`: time goes back by 0.5 s",
        ),
        // 0.09999999999999998 in binary.
        (
            format!("{CSV}1,0,0,0\n0.9,0,0,0\n"),
            "line 4, sample 2, field `t`: time goes back by 0.1 s",
        ),
        (
            format!("{CSV}0,0.3,0,0\n"),
            "line 3, sample 1: a jump: 0.3000 m and 0.0000 rad within 0 s",
        ),
        (format!("{CSV}1e-6,0.3,0,0\n"), "line 3, sample 1: a jump"),
        (
            format!("{CSV}1e-5,0,0,0\n"),
            "line 3, sample 1: the samples span 1e-5 s",
        ),
        (
            format!("{CSV}60,1,0,0\n"),
            "line 3, sample 1, field `t`: a gap of 60.0 s",
        ),
        (
            format!("{CSV}1,0,1e300,0\n"),
            "line 3, sample 1, field `y`: 1e300 is more than 2000 m from the origin",
        ),
        (
            CSV.replace("0,0,0,0", "0,-2000.01,0,0"),
            "line 2, sample 0, field `x`: -2000.01 is more than 2000 m from the origin; the whole base computes in single precision: take an origin",
        ),
        (
            format!("{CSV}1.7e18,0,0,0\n"),
            "line 3, sample 1, field `t`: 1.7e18 is not within ±1e11",
        ),
        (
            "0 1 2 3 0 0 0 1\n1 1 2 3 0 0 1\n".to_owned(),
            "line 2, sample 1: 7 values where there should be 8",
        ),
        (
            "0 1 2 3 0 0 0 2\n".to_owned(),
            "line 1, sample 0: the quaternion has norm 2.0000, not 1",
        ),
        (
            "0 0 0 0 0 0 0 1\n1 0 0 0 1 0 0 0\n".to_owned(),
            "line 2, sample 1: not planar: the body's vertical leans 3.142 rad",
        ),
        (
            wpilib("{\"time\":1}"),
            "line 3, sample 1: missing field `pose`",
        ),
        (
            wpilib(&STATE.replace("\"x\":0", "\"x\":null")),
            "line 3, sample 1, field `pose.translation.x`: invalid type: null, expected f64",
        ),
        (
            wpilib(&STATE.replace("\"curvature\":0", "\"curvature\":\"tight\"")),
            "line 3, sample 1, field `curvature`: `tight` is not a number",
        ),
        (wpilib("{"), "line 3, field `[1]`: key must be a string"),
        (
            "{\"trajectory\":{\"samples\":3}}".to_owned(),
            "line 1, field `trajectory.samples`: invalid type: integer `3`, expected an array of samples",
        ),
        (
            "{\"samples\":[]}".to_owned(),
            "field `samples`: too few samples (0); at least two are needed",
        ),
        (
            "{\"a\":1}".to_owned(),
            "field `trajectory`: not a trajectory file",
        ),
    ] {
        let refusal = refusal(text.as_bytes())?.to_string();
        assert!(
            refusal.starts_with(message),
            "\n  {refusal}\nis not\n  {message}\nin {text}"
        );
    }
    Ok(())
}

/// A circle and a line by their headings in degrees, however far apart the samples are; the same in radians is driven.
#[test]
fn headings_in_degrees_are_said_to_be() -> Result<(), String> {
    let file = |unit: f64, dt: f64, pose: fn(f64) -> (f64, f64, f64)| {
        let mut text = "t,x,y,theta\n".to_owned();
        for k in 0..12 {
            let t = dt * f64::from(k);
            let (x, y, theta) = pose(0.5 * t);
            text += &format!("{t},{x:.4},{y:.4},{:.4}\n", unit * theta);
        }
        text
    };
    let circle = |way: f64| (way.sin(), 1.0 - way.cos(), way);
    let slant = |way: f64| (way, way, std::f64::consts::FRAC_PI_4);
    for (dt, pose) in [
        (1.0, circle as fn(f64) -> (f64, f64, f64)),
        (0.3, circle),
        (0.1, slant),
    ] {
        let refusal = refusal(file(1f64.to_degrees(), dt, pose).as_bytes())?;
        assert!(
            matches!(refusal.reason, Reason::Degrees { .. }),
            "{refusal}"
        );
        let said = refusal.to_string();
        assert!(
            said.contains("field `theta`") && said.ends_with("theta is in radians"),
            "{said}"
        );
        let driven = import(file(1.0, dt, pose).as_bytes(), &Options::default());
        assert!(driven.is_ok(), "{driven:?}");
    }
    Ok(())
}

#[test]
fn paths_without_time_are_told_what_is_missing() -> Result<(), Box<dyn Error>> {
    for (name, untimed) in [
        ("pathweaver.path", Untimed::PathWeaver),
        ("pathplanner.path", Untimed::PathPlanner),
        ("choreo_empty.traj", Untimed::Choreo),
    ] {
        let refusal = fixture(name)?;
        assert_eq!(refusal.reason, Reason::Untimed(untimed), "{name}");
    }
    Ok(())
}

#[test]
fn other_bases_and_other_dimensions_are_refused() -> Result<(), Box<dyn Error>> {
    assert_eq!(
        fixture("choreo_swerve.traj")?.reason,
        Reason::OtherDrive("swerve")
    );
    assert_eq!(fixture("choreo_2024.traj")?.reason, Reason::ChoreoTooOld);
    let holonomic = r#"{"samples":[{"time":0,"pose":{"translation":{"x":0,"y":0},"rotation":{"radians":0}},
        "velocity":{"vx":0,"vy":1,"omega":0},"acceleration":{"ax":0,"ay":0,"alpha":0}}]}"#;
    let holonomic = refusal(holonomic.as_bytes())?;
    assert_eq!(holonomic.reason, Reason::OtherDrive("holonomic"));
    assert_eq!(holonomic.place.line, Some(1));
    let climbing = fixture("tum_climbing.txt")?;
    assert_eq!(climbing.place.line, Some(22));
    assert!(matches!(climbing.reason, Reason::NotPlanar(_)));
    let sideways = fixture("table_sideways.csv")?;
    assert!(
        sideways.place.line.is_some_and(|line| line > 11),
        "{sideways}"
    );
    assert!(
        matches!(sideways.reason, Reason::Undrivable { sideways_m, forward_m, .. }
            if (sideways_m - 0.03).abs() < 1e-9 && forward_m.abs() < 1e-9),
        "{sideways}"
    );
    // A pose aside, from which the way back is as long: the first of both.
    let spike = refusal(b"t,x,y,theta\n0,0,0,0\n1,0.1,0,0\n2,0.2,0.5,0\n3,0.3,0,0\n4,0.4,0,0\n")?;
    assert_eq!(spike.place.line, Some(4), "{spike}");
    Ok(())
}

#[test]
fn binary_and_long_files_are_refused_early() -> Result<(), String> {
    let binary = refusal(b"t,x,y,theta\n0,0,\xff,0\n")?;
    assert_eq!(
        (binary.place.line, binary.reason),
        (Some(2), Reason::NotText { offset: 16 })
    );
    let sixteen = refusal(b"\xff\xfet\0,\0")?.to_string();
    assert!(sixteen.ends_with("has to be saved as UTF-8"), "{sixteen}");
    let semicolons = refusal(b"t;x;y;theta\n0;0;0;0\n")?.to_string();
    assert!(
        semicolons.contains("with commas and not semicolons"),
        "{semicolons}"
    );
    let limit = MAX_SAMPLES;
    let mut table = "t,x,y,theta\n".to_owned();
    let mut poses = String::new();
    for i in 0..=limit {
        table.push_str(&format!("{i},0,0,0\n"));
        poses.push_str(&format!("{i} 0 0 0 0 0 0 1\n"));
    }
    let array = format!("[{}1]", "1,".repeat(limit));
    for text in [table, poses, array] {
        assert_eq!(
            refusal(text.as_bytes())?.reason,
            Reason::TooManySamples { limit }
        );
    }
    let deep = "[".repeat(1 << 20);
    assert!(matches!(
        refusal(deep.as_bytes())?.reason,
        Reason::Malformed(_)
    ));
    Ok(())
}
