//! Logs that do not tell enough, contradict themselves, or cannot be read.

use crate::robot::{RECORDER, Recorder, Robot, random, recommended};
use Quantity as Q;
use sim_host::identify::{
    Drive, Fix, Identified, IdentifyError, Known, KnownError, Log, LogError, Options, Quantity,
    Verdict, identify,
};

fn robot() -> Robot {
    Robot::draw(&mut random(1))
}

fn recorded(drive_of: impl Fn(f64) -> [f64; 2]) -> Log {
    robot().record(&RECORDER, &mut random(2), drive_of)
}

fn options() -> Options {
    Options {
        latency_s: RECORDER.latency_s,
        ..Options::default()
    }
}

fn why(found: &Identified, quantity: Quantity) -> &str {
    match found.of(quantity) {
        Some(Verdict::NotIdentifiable { why, .. }) => why,
        other => panic!("{}: {other:?}", quantity.name()),
    }
}

fn value(found: &Identified, quantity: Quantity) -> f64 {
    match found.of(quantity) {
        Some(Verdict::Identified { value, .. }) => *value,
        other => panic!("{}: {other:?}", quantity.name()),
    }
}

#[test]
fn a_robot_that_never_turns_shows_no_track() {
    // Duties that make both wheels roll alike although their motors differ, as a heading hold does:
    // here the same robot with the same motors on both sides.
    let mut same = robot();
    for pair in [
        &mut same.radius,
        &mut same.constant,
        &mut same.resistance,
        &mut same.viscous,
        &mut same.coulomb,
    ] {
        pair[1] = pair[0];
    }
    let straight = |t: f64| [if t % 1.4 < 0.7 { 0.3 } else { 0.7 }; 2];
    let log = same.record(&RECORDER, &mut random(3), straight);
    let found = identify(&log, &options()).expect("nothing contradicts");
    for quantity in [Q::Track, Q::Inertia] {
        let why = why(&found, quantity);
        assert!(why.contains("different rates"), "{why}");
    }
    // The mean radius shows, and with it the mass; the wheels' own inertia is stated with neither.
    let radius = 0.5 * (value(&found, Q::RadiusRight) + value(&found, Q::RadiusLeft));
    assert!((radius / same.radius[0] - 1.0).abs() < 0.01, "{radius}");
}

#[test]
fn a_robot_that_stands_shows_nothing() {
    let found = identify(&recorded(|_| [0.0; 2]), &options()).expect("nothing contradicts");
    for quantity in Q::ALL {
        if let Some(verdict) = found.of(quantity) {
            let number = matches!(verdict, Verdict::Identified { .. });
            assert!(!number, "{}: {verdict:?}", quantity.name());
        }
    }
    assert!(found.combinations.is_empty(), "{:?}", found.combinations);
}

/// One that stands is only told so.
#[test]
fn a_log_in_milliseconds_is_asked_for_its_unit() {
    let asks = |log: &Log| {
        let found = identify(log, &options()).expect("nothing contradicts");
        let why = why(&found, Q::Mass);
        assert!(why.starts_with("the wheels hardly ever turned"), "{why}");
        why.ends_with("rows are 10 s apart: is `t` in s?")
    };
    let mut log = recorded(recommended);
    for t in &mut log.t {
        *t *= 1.0e3;
    }
    assert!(asks(&log));
    assert!(!asks(&recorded(|_| [0.0; 2])));
}

#[test]
fn stated_values_that_contradict_the_log_are_reported() {
    let mut options = options();
    options.known.state("mass=20").expect("a name");
    let found = identify(&recorded(recommended), &options).expect("signs agree");
    assert!(
        found.warnings.iter().any(|w| w.contains("contradict")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn reversed_signs_are_named() {
    let mut log = recorded(recommended);
    for command in &mut log.command {
        command[1] = -command[1];
    }
    assert_eq!(
        identify(&log, &options()),
        Err(IdentifyError::Against("left"))
    );
    let mut log = recorded(recommended);
    for angle in &mut log.angle {
        *angle = [-angle[0], -angle[1]];
    }
    assert!(matches!(
        identify(&log, &options()),
        Err(IdentifyError::Backwards(_))
    ));
}

#[test]
fn robots_that_there_are_not_are_refused_with_the_limit() {
    // Positions in mm: wheels of some 80 m.
    let mut log = recorded(recommended);
    for fix in &mut log.fixes {
        fix.pose[0] *= 1.0e3;
        fix.pose[1] *= 1.0e3;
    }
    let error = identify(&log, &options()).expect_err("no such robot");
    let text = error.to_string();
    for part in [
        "radius_right comes out as 8",
        " m, and a robot has at most 10: ",
        "x and y in m",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// Positions in centimetres or inches are within the limits of a base's file, and of no robot: of one whose mass shows by that
/// mass, else by what its tyres would have to hold. What a metre is shows in nothing but what falls or is weighed.
#[test]
fn robots_that_cannot_be_on_their_wheels_are_refused() {
    let blind = Recorder {
        drive: Drive::Duty,
        current_sd: None,
        ..RECORDER
    };
    // The limit as a user writes it, without an exponent.
    let light = [
        "the air between its wheels",
        "and a robot has at least 0.001",
    ];
    for (recorder, told) in [(RECORDER, light), (blind, ["m/s²"; 2])] {
        for seed in 0..10 {
            let mut random = random(100 + seed);
            let robot = Robot::draw(&mut random);
            let log = robot.record(&recorder, &mut random, recommended);
            identify(&log, &options()).expect("in metres");
            for in_a_metre in [100.0, 39.4] {
                let mut log = log.clone();
                for fix in &mut log.fixes {
                    fix.pose[0] *= in_a_metre;
                    fix.pose[1] *= in_a_metre;
                }
                let error = identify(&log, &options()).expect_err("no such robot");
                let text = error.to_string();
                assert!(
                    told.iter().any(|part| text.contains(part)) && text.contains("in SI units"),
                    "{in_a_metre}: {text}"
                );
            }
        }
    }
}

#[test]
fn commands_of_another_row_are_reported() {
    let mut log = recorded(recommended);
    // Each a row later than it acted: wheels move 10 ms before.
    log.command.rotate_right(1);
    let found = identify(&log, &options()).expect("signs agree");
    assert!(
        found
            .warnings
            .iter()
            .any(|w| w.contains("before their commands")),
        "{:?}",
        found.warnings
    );
    let reported = found.combinations.iter().any(|e| e.name.contains("lag"));
    assert!(!reported, "{:?}", found.combinations);
}

fn refused(header: &str, bad: &str) -> LogError {
    let rows: String = (0..30)
        .map(|k| format!("{},0.1,0.1,{k},{k},,,\n", 0.01 * f64::from(k)))
        .collect();
    let text = format!("{header}\n{rows}{bad}");
    Log::read(text.as_bytes(), Some(1000.0)).expect_err("refused")
}

#[test]
fn errors_name_line_and_column() {
    let header = "t,duty_right,duty_left,counts_right,counts_left,x,y,theta";
    for (bad, line, column) in [
        ("1.0,0.1,zero,1,1,,,\n", 32, "duty_left"),
        ("0.1,0.1,0.1,1,1,,,\n", 32, "t"),
        ("1.0,1.5,0.1,1,1,,,\n", 32, "duty_right"),
        ("1.0,0.1,0.1,inf,1,,,\n", 32, "counts_right"),
        ("1.0,0.1,0.1,1,1e300,,,\n", 32, "counts_left"),
        ("1.0,0.1,0.1,,1,,,\n", 32, "counts_right"),
        ("1.0,0.1,0.1,1,1,0.5,,0.1\n", 32, "y"),
    ] {
        match refused(header, bad) {
            LogError::Cell {
                line: found,
                column: name,
                ..
            } => assert_eq!((found, name.as_str()), (line, column), "{bad}"),
            other => panic!("{bad}: {other}"),
        }
    }
    for header in [
        "time,duty_right,duty_left,counts_right,counts_left,x,y,theta",
        "t,duty_right,duty,counts_right,counts_left,x,y,theta",
        "t,duty_right,duty_left,counts_right,counts_left,x,y,heading",
        "t,a,b,counts_right,counts_left,x,y,theta",
        "t,duty_right,duty_left,counts_right,counts_left,x,x,theta",
        "t,duty_right,duty_left,counts_right,counts_left,t,y,theta",
    ] {
        assert!(
            matches!(refused(header, ""), LogError::Columns(1, _)),
            "{header}"
        );
    }
}

/// A log may have comments where a trajectory file may; lines are counted with them.
#[test]
fn comments_are_skipped_and_counted() {
    let header = "t,duty_right,duty_left,angle_right,angle_left";
    let rows: Vec<String> = (0..30)
        .map(|k| format!("{},0.1,0.1,{k},{k}", 0.01 * f64::from(k)))
        .collect();
    let plain = format!("{header}\n{}\n", rows.join("\n"));
    let noted = format!(
        "\u{feff}# drive 7\n\n{header}\n{}\n# the end",
        rows.join("\n\t# note\n")
    );
    let log = Log::read(plain.as_bytes(), None).expect("a sound log");
    assert_eq!(Log::read(noted.as_bytes(), None).expect("the same"), log);
    for (text, told) in [
        (
            noted.replace("0.01,0.1", "0.01,soon"),
            "line 6, column `duty_right`: `soon` is not a number",
        ),
        (
            noted.replace("0.01,0.1,", "0.01,"),
            "line 6: 4 values where there should be 5",
        ),
        (
            noted.replace("t,duty", "time,duty"),
            "line 3: column `t` is missing: names are in small letters, with commas and not semicolons or tabs between them",
        ),
    ] {
        let error = Log::read(text.as_bytes(), None).expect_err("refused");
        assert_eq!(error.to_string(), told);
    }
    for empty in ["", "\n", "# nothing\n# else"] {
        let error = Log::read(empty.as_bytes(), None).expect_err("refused");
        assert_eq!(
            error.to_string(),
            "the file: the file is empty",
            "{empty:?}"
        );
    }
    let error = Log::read(b"t,duty_right\n\xff", None).expect_err("refused");
    assert!(error.to_string().contains("line 2: not text"), "{error}");
}

#[test]
fn statements_are_checked() {
    let state = |text: &str| Known::default().state(text);
    assert_eq!(state("radius=0.1,mass=3,viscous=0,gear=20"), Ok(()));
    assert!(matches!(state("mass"), Err(KnownError::Form(_))));
    assert!(matches!(state("weight=3"), Err(KnownError::Name { .. })));
    for bad in ["mass=0", "mass=-1", "mass=nan", "track=x", "gear=0"] {
        assert!(matches!(state(bad), Err(KnownError::Value { .. })), "{bad}");
    }
    for (twice, name) in [
        ("mass=3,mass=4", "mass"),
        ("radius=0.1,radius_left=0.1", "radius_left"),
        ("gear=20, gear=20", "gear"),
        ("efficiency=0.8+-0.1,efficiency=0.8", "efficiency"),
    ] {
        assert_eq!(state(twice), Err(KnownError::Twice(name.to_owned())));
    }
}

/// A battery sags under a duty by what the row after it measures; of the last row nobody knows.
#[test]
fn a_duty_counts_with_the_supply_under_it() {
    let mut text = "t,duty_right,duty_left,supply,angle_right,angle_left\n".to_owned();
    for row in 0..20 {
        let (t, duty, supply) = (0.02 * f64::from(row), 0.5, 20 - row);
        text += &format!("{t},{duty},{},{supply},0,0\n", -duty);
    }
    let log = Log::read(text.as_bytes(), None).expect("a sound log");
    let under: Vec<_> = log.command.iter().map(|[right, _]| 2.0 * right).collect();
    let next: Vec<_> = (1..20).rev().chain([1]).map(f64::from).collect();
    assert_eq!(under, next);
}

/// The rows of `log` that `kept` says, and the poses in them.
fn without_rows(log: &Log, kept: impl Fn(usize) -> bool) -> Log {
    let rows: Vec<usize> = (0..log.t.len()).filter(|row| kept(*row)).collect();
    let pairs = |of: &[[f64; 2]]| rows.iter().map(|row| of[*row]).collect();
    let fixes = log.fixes.iter().filter_map(|fix| {
        let row = rows.binary_search(&fix.row).ok()?;
        Some(Fix { row, ..*fix })
    });
    Log {
        t: rows.iter().map(|row| log.t[*row]).collect(),
        command: pairs(&log.command),
        angle: pairs(&log.angle),
        current: log.current.as_deref().map(pairs),
        fixes: fixes.collect(),
        ..log.clone()
    }
}

/// Loggers lose rows, and pause: a command that is not in the log acted meanwhile. What the rest says is true, and it is said that
/// rows are missing.
#[test]
fn rows_that_are_missing_make_nothing_false() {
    // By ramps, so that many of the lost rows had commands of their own.
    let ramps = |t: f64| {
        let wave = |period: f64| 0.55 + 0.25 * (std::f64::consts::TAU * t / period).sin();
        match t {
            t if t < 8.0 => [wave(0.7); 2],
            t if t < 13.0 => [wave(0.7), -wave(0.7)],
            t if t < 19.0 => [-wave(0.8), -wave(1.1)],
            _ => [wave(1.1), wave(0.7)],
        }
    };
    for (seed, drive) in [(1, recommended as fn(f64) -> [f64; 2]), (2, ramps)] {
        let mut random = random(seed);
        let robot = Robot::draw(&mut random);
        let whole = robot.record(&RECORDER, &mut random, drive);
        type Kept<'a> = &'a dyn Fn(usize) -> bool;
        let losses: [(&str, Kept); 2] = [
            ("pause of 0.4 s", &|row| !(401..440).contains(&row)),
            ("pause of 4 s", &|row| !(401..800).contains(&row)),
        ];
        let all = identify(&whole, &options()).expect("nothing contradicts");
        assert!(all.warnings.is_empty(), "{:?}", all.warnings);
        for (name, kept) in losses {
            let found = identify(&without_rows(&whole, kept), &options()).expect(name);
            let missing = found
                .warnings
                .iter()
                .any(|w| w.contains("rows are missing"));
            assert!(missing, "{name}: {:?}", found.warnings);
            for quantity in Q::ALL {
                let (
                    Some(Verdict::Identified { value, half_width }),
                    Some(Verdict::Identified {
                        value: of_all,
                        half_width: wide,
                    }),
                ) = (found.of(quantity), all.of(quantity))
                else {
                    continue;
                };
                assert!(
                    (value - of_all).abs() <= half_width + wide && *half_width < 8.0 * wide,
                    "seed {seed}, {name}, {}: {value} ± {half_width} and {of_all} ± {wide}",
                    quantity.name()
                );
            }
            value(&found, Q::Mass);
        }
        // Every stretch has such rows: only the poses say something.
        let found = without_rows(&whole, |row| row % 17 != 5);
        let found = identify(&found, &options()).expect("nothing contradicts");
        for quantity in [Q::Mass, Q::ResistanceLeft, Q::CoulombRight] {
            let why = why(&found, quantity);
            assert!(why.contains("rows are missing so often"), "{why}");
        }
        value(&found, Q::Track);
    }
}

#[test]
fn counters_that_jump_or_stand_are_named() {
    let log = recorded(recommended);
    let turn = std::f64::consts::TAU;
    // A tenth of a turn lost, a counter of 16 bits, a reset in the midst of the drive.
    let angles: [fn(f64, f64) -> f64; 3] = [
        |angle, turn| angle - 0.1 * turn,
        |angle, turn| angle - 32.0 * turn,
        |_, _| 0.0,
    ];
    for change in angles {
        let mut log = log.clone();
        let from = log.angle[1500];
        for angle in &mut log.angle[1500..] {
            angle[1] = angle[1] - from[1] + change(from[1], turn);
        }
        let error = identify(&log, &options()).expect_err("a jump");
        let at = matches!(error, IdentifyError::Jump { side: "left", t_s, .. } if (t_s - 15.0).abs() < 1e-9);
        assert!(at, "{error}");
    }
    let mut dead = log;
    for angle in &mut dead.angle {
        angle[0] = 1.0;
    }
    assert_eq!(
        identify(&dead, &options()),
        Err(IdentifyError::Still("right"))
    );
}

#[test]
fn currents_without_a_sign_are_named() {
    let log = recorded(recommended);
    let with = |change: fn(f64) -> f64| {
        let mut log = log.clone();
        for current in log.current.iter_mut().flatten() {
            current[1] = change(current[1]);
        }
        identify(&log, &options())
    };
    let named = |commands| {
        Err(IdentifyError::Current {
            side: "left",
            commands,
        })
    };
    assert_eq!(with(f64::abs), named("negative"));
    assert_eq!(with(|current| -current), named("positive"));
}

/// Poses of another frame fit some robot, too, which is another one.
#[test]
fn poses_of_another_frame_are_named() {
    let with = |change: fn(&mut [f64; 3])| {
        let mut log = recorded(recommended);
        for fix in &mut log.fixes {
            change(&mut fix.pose);
        }
        identify(&log, &options())
    };
    let mirrored = with(|pose| *pose = [pose[0], -pose[1], -pose[2]]);
    assert_eq!(mirrored, Err(IdentifyError::Mirrored));
    let degrees = with(|pose| pose[2] = pose[2].to_degrees());
    assert!(
        matches!(degrees, Err(IdentifyError::Headings { off_rad }) if off_rad > 1.0),
        "{degrees:?}"
    );
    let mut swapped = recorded(recommended);
    let pairs = swapped.command.iter_mut().chain(&mut swapped.angle);
    for pair in pairs.chain(swapped.current.iter_mut().flatten()) {
        pair.reverse();
    }
    assert_eq!(identify(&swapped, &options()), Err(IdentifyError::Mirrored));
}
