//! A robot's file to gains, a verification and constants.

use crate::program::sim_host;
use firmware_demo::robots;
use sim_host::constants::{c_header, module_name, period_us, rust};
use sim_host::mission::BaseSpec;
use sim_host::part::{AT_ONCE, MAX_SEEDS};
use sim_host::scenario::{BASES, BuiltInBase};
use sim_host::trials::{Condition, Course, Figures};
use sim_host::tune::{KNOBS, update};
use sim_host::verify::{Run, Verification, shortcoming, verdict, verify};
use std::error::Error;
use std::num::NonZeroU32;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use tests::boards_target;
use tests::stated::{At, Stated};

const NAMES: [&str; 3] = ["paper-30kg", "lab-10kg", "hobby-1kg"];

fn base(name: &str) -> Result<BaseSpec, Box<dyn Error>> {
    Ok(BuiltInBase::find(name).ok_or("not built in")?.base()?)
}

/// From a robot's file to the image that is flashed, as the README has it: `constants`, and one line for the board.
#[test]
fn a_board_drives_the_robot_of_a_file() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let file = std::fs::read_to_string(root.join("boards/robot.toml"))?;
    // A speed and a track that no other robot has.
    let mine = file.replace("speed = 0.8", "speed = 0.8321");
    let mine = mine.replace("l = 0.160", "l = 0.16543");
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, mine)?;
    let made = sim_host(folder.path(), &["constants", "mine.toml", "--out", "."]);
    assert!(made.status.success(), "{made:?}");
    let image = |robot: Option<PathBuf>| -> Result<Vec<u8>, Box<dyn Error>> {
        let mut build = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        build.args(["build", "--release", "--locked"]);
        build.current_dir(root.join("boards/stm32f411"));
        build.env("CARGO_TARGET_DIR", boards_target());
        // Without `ROBOT` it is the one of the board's own line.
        build
            .env_remove("ROBOT")
            .envs(robot.map(|path| ("ROBOT", path)));
        let built = build.output()?;
        assert!(built.status.success(), "{built:?}");
        let elf = "thumbv7em-none-eabihf/release/board-stm32f411";
        Ok(std::fs::read(boards_target().join(elf))?)
    };
    let has = |image: &[u8], number: f32| image.windows(4).any(|word| word == number.to_le_bytes());
    let changed = image(Some(folder.path().join("mine.rs")))?;
    let own = image(None)?;
    for number in [0.8321, 0.16543] {
        assert!(has(&changed, number), "{number} is not in the image");
        assert!(!has(&own, number), "{number} is in the board's own image");
    }
    Ok(())
}

#[test]
fn constants_in_the_firmware_are_those_of_the_files() -> Result<(), Box<dyn Error>> {
    let boards = Path::new(env!("CARGO_MANIFEST_DIR")).join("../boards");
    let text = std::fs::read_to_string(boards.join("robot.toml"))?;
    let robot = BaseSpec::parse("robot.toml", &text)?;
    let made = rust("robot.toml", &robot).map_err(|e| e.to_string())?;
    assert_eq!(
        made,
        std::fs::read_to_string(boards.join("robot.rs"))?,
        "run `sim-host constants boards/robot.toml --out boards`"
    );
    for name in NAMES {
        let made = rust(&format!("{name}.toml"), &base(name)?).map_err(|e| e.to_string())?;
        let path: PathBuf = [
            env!("CARGO_MANIFEST_DIR"),
            "../firmware-demo/src/robots",
            &format!("{}.rs", module_name(name)),
        ]
        .iter()
        .collect();
        let kept = std::fs::read_to_string(&path)?;
        assert_eq!(
            made, kept,
            "run `sim-host constants {name} --out firmware-demo/src/robots`"
        );
    }
    Ok(())
}

/// The robot of the C examples, which the tests of `bindings/c` compile and drive, is that of its file.
#[test]
fn the_robot_of_the_c_examples_is_that_of_its_file() -> Result<(), Box<dyn Error>> {
    let name = "lab-10kg";
    let made = c_header(&format!("{name}.toml"), name, &base(name)?).map_err(|e| e.to_string())?;
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bindings/c/examples/lab_10kg.h");
    assert_eq!(
        made,
        std::fs::read_to_string(kept)?,
        "run `sim-host constants {name} --c --out bindings/c/examples`"
    );
    Ok(())
}

/// Constants of a base whose drivers close their own speed loop are those that the simulator runs.
#[test]
fn speed_drivers_are_in_the_constants() -> Result<(), Box<dyn Error>> {
    let built_in = BuiltInBase::find("lab-10kg").ok_or("not built in")?;
    let base = built_in.with_speed_driver()?;
    let constants = rust("mine.toml", &base).map_err(|e| e.to_string())?;
    // 24 V over 26 · 45 mV s; a third more than the 0.35 N m of its wheels.
    let driver = "    driver: DriverParams::Speeds(SpeedParams {
        max_speed_rad_s: 20.512821,
        min_speed_rad_s: 0.0,
        lag_s: 0.02,
        breakaway_nm: 0.455,
    }),
";
    assert!(constants.contains(driver), "{constants}");
    assert!(constants.contains("use controller_core::motor::{DriverParams, SpeedParams};\n"));
    Ok(())
}

/// The owner of a robot changes a reaction in its file; what cannot work is refused with its place.
#[test]
fn reactions_to_faults_come_from_the_file() -> Result<(), Box<dyn Error>> {
    use controller_core::safety::{FaultKind, PolicyParams, Reaction, Response};
    let built_in = BuiltInBase::find("lab-10kg").ok_or("not built in")?;
    let with = |lines: &str| format!("{}\n[policy]\n{lines}\n", built_in.text);
    let text = with("pose_stale = { reaction = \"brake\", latch = true }");
    let base = BaseSpec::parse("mine.toml", &text)?;
    let response = Response::latched(Reaction::Brake);
    let wanted = PolicyParams::DEFAULT.with(FaultKind::PoseStale, response);
    let params =
        sim_host::closed_loop::params(&base, period_us(&base)).map_err(|e| e.to_string())?;
    assert_eq!(params.policy, wanted);
    let constants = rust("mine.toml", &base).map_err(|e| e.to_string())?;
    assert!(constants.contains("pose_stale: Response::latched(Reaction::Brake)"));
    // Nothing is left to stop by.
    let text = with("encoder_stuck = { reaction = \"controlled-stop\", latch = true }");
    let refused = BaseSpec::parse("mine.toml", &text)
        .err()
        .ok_or("was taken")?;
    let line = text.lines().count();
    assert_eq!(
        (refused.key.as_str(), refused.line),
        ("policy.encoder_stuck", Some(line))
    );
    assert!(
        refused.message.contains("leaves no measurement"),
        "{refused}"
    );
    let refused = BaseSpec::parse("mine.toml", &with("pose_gone = 1"));
    assert!(refused.is_err_and(|error| error.to_string().contains("pose_gone")));
    Ok(())
}

#[test]
fn simulator_and_firmware_have_the_same_bits() -> Result<(), Box<dyn Error>> {
    let robots = [robots::PAPER_30KG, robots::LAB_10KG, robots::HOBBY_1KG];
    for (name, robot) in NAMES.into_iter().zip(robots) {
        let base = base(name)?;
        assert_eq!(robot.period_us, period_us(&base));
        let simulated =
            sim_host::closed_loop::params(&base, robot.period_us).map_err(|e| e.to_string())?;
        // The text has the shortest digits that give the same bits back, and the sign of a zero.
        assert_eq!(
            format!("{simulated:?}"),
            format!("{:?}", robot.base),
            "{name}"
        );
        assert!(
            robot
                .base
                .validate_with::<controller_core::maths::Single>()
                .is_ok(),
            "{name}"
        );
    }
    Ok(())
}

#[test]
fn a_verification_is_the_same_every_time_and_names_what_fails() -> Result<(), Box<dyn Error>> {
    let base = base("hobby-1kg")?;
    let seeds = NonZeroU32::MIN;
    let (verification, again) = (
        verify(&base, 0, seeds, || {})?,
        verify(&base, 0, seeds, || {})?,
    );
    assert_eq!(verification, again);
    assert_eq!(
        (verification.runs.len(), verification.cases.len()),
        (18, 18)
    );
    let good = verification
        .runs
        .iter()
        .filter(|run| shortcoming(&run.figures).is_none());
    assert_eq!(
        good.count(),
        verification
            .cases
            .iter()
            .map(|case| case.good)
            .sum::<usize>()
    );
    let worst = verification.worst().ok_or("no runs")?;
    assert_eq!(verification.holds(), shortcoming(&worst.figures).is_none());
    Ok(())
}

/// What is to stop unwinds once for each piece of work that the threads have been given: 1,800,000 of them took 6.5 s.
#[test]
fn the_longest_verification_stops_soon() -> Result<(), Box<dyn Error>> {
    let (base, unwound) = (base("hobby-1kg")?, AtomicUsize::new(0));
    let stop = || {
        unwound.fetch_add(1, Ordering::Relaxed);
        resume_unwind(Box::new(()))
    };
    let stopped = catch_unwind(AssertUnwindSafe(|| verify(&base, 1, MAX_SEEDS, stop)));
    let pieces = unwound.into_inner();
    assert!(stopped.is_err() && pieces <= AT_ONCE, "{pieces}");
    Ok(())
}

/// Worlds that are kept for the test below, drawn by the operating system: nothing was developed, tuned or tried in
/// them. Whoever looks into one draws anew.
const KEPT_SEED: u64 = 162_447_189;

/// What README says of the three bases as shipped, and of gains that follow from their limits.
#[test]
fn the_readme_states_the_verification() -> Result<(), Box<dyn Error>> {
    let seeds = NonZeroU32::new(10).ok_or("0")?;
    let (mut times, mut amiss) = (Vec::new(), [0; 2]);
    for name in NAMES {
        let base = base(name)?;
        let plain = BaseSpec {
            gains: None,
            ..base.clone()
        };
        for (base, amiss) in [base, plain].iter().zip(&mut amiss) {
            let verification = verify(base, KEPT_SEED, seeds, || {})?;
            let runs = verification.runs.iter().map(|run| &run.figures);
            *amiss += runs
                .clone()
                .filter(|run| shortcoming(run).is_some())
                .count();
            if base.gains.is_some() {
                times.extend(runs.map(|run| run.time_s));
            }
        }
    }
    times.sort_by(f64::total_cmp);
    let (runs, [tuned, plain]) = (times.len() as f64, amiss.map(|runs| runs as f64));
    let mut readme = Stated::of("README.md");
    readme.exactly(
        At::Phrase("(# of #, ten worlds for each course and condition; half of them within # s, all within #)"),
        &[
            runs - tuned,
            runs,
            times[times.len() / 2],
            times[times.len() - 1],
        ],
    );
    readme.exactly(
        At::Phrase("or otherwise amiss, in # of `verify`'s # runs"),
        &[plain, runs],
    );
    Ok(())
}

/// `docs/your-robot.md` has what the programs print.
#[test]
fn the_page_shows_what_the_programs_print() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let text = BuiltInBase::find("hobby-1kg").ok_or("not built in")?.text;
    let text = text.replacen("1 kg hobby base", "my robot", 1);
    std::fs::write(here.path().join("robot.toml"), &text)?;
    let mut page = Stated::of("docs/your-robot.md");
    let mut shown = |heading: &str, arguments: &[&str]| -> Result<(), Box<dyn Error>> {
        let printed = String::from_utf8(sim_host(here.path(), arguments).stdout)?;
        let (printed, _) = printed.rsplit_once("results are in").ok_or("no end")?;
        page.block(heading, printed);
        Ok(())
    };
    shown("3. Verify", &["verify", "robot.toml", "--seeds", "5"])?;
    // All gains at 0.4 of theirs.
    let mut gains = BaseSpec::parse("robot.toml", &text)?.motion().gains;
    for knob in KNOBS {
        let slower = 0.4 * knob.of(&gains);
        knob.put(&mut gains, slower);
    }
    std::fs::write(here.path().join("robot.toml"), update(&text, &gains)?)?;
    shown("2. Tune", &["tune", "robot.toml", "--evaluations", "36"])
}

/// Poses that are better than a robot can park by keep no robot from parking: the bases with motion capture instead of their camera.
#[test]
fn precise_poses_park_a_base_sooner() -> Result<(), Box<dyn Error>> {
    let seeds = NonZeroU32::new(10).ok_or("0")?;
    let mut page = Stated::of("docs/your-robot.md");
    for (label, noise, rate_hz) in [
        ("1 mm and 1 mrad at 100 Hz", 1e-3, 100.0),
        ("0.5 mm and 0.5 mrad at 20 Hz", 0.5e-3, 20.0),
    ] {
        let (mut follows, mut parks) = (Vec::new(), Vec::new());
        let (mut amiss, mut off_m, mut off_rad) = (0, 0.0_f64, 0.0_f64);
        for name in NAMES {
            let mut base = base(name)?;
            let hardware = base.hardware.as_mut().ok_or("no hardware")?;
            let source = hardware.pose_source.as_mut().ok_or("no poses")?;
            (source.rate_hz, source.latency_s) = (rate_hz, 0.01);
            (source.noise_m, source.noise_rad) = (noise, noise);
            for run in &verify(&base, KEPT_SEED, seeds, || {})?.runs {
                let times = match run.course {
                    Course::Park => &mut parks,
                    _ => &mut follows,
                };
                times.push(run.figures.time_s);
                amiss += u32::from(shortcoming(&run.figures).is_some());
                off_m = off_m.max(run.figures.error_m);
                off_rad = off_rad.max(run.figures.error_rad.abs());
            }
        }
        let runs = follows.len() + parks.len();
        let quantiles = |times: &mut Vec<f64>| {
            times.sort_by(f64::total_cmp);
            [times[times.len() / 2], times[times.len() - 1]]
        };
        let ([half, last], [half_park, last_park]) =
            (quantiles(&mut follows), quantiles(&mut parks));
        page.exactly(
            At::Row("3. Verify", label),
            &[
                runs as f64,
                f64::from(amiss),
                half,
                last,
                half_park,
                last_park,
                1e3 * off_m,
                1e3 * off_rad,
            ],
        );
    }
    Ok(())
}

/// How many runs fail.
fn failing(runs: &[Run]) -> f64 {
    let amiss = |run: &&Run| shortcoming(&run.figures).is_some();
    runs.iter().filter(amiss).count() as f64
}

/// A gyro, which shows what friction compensation does where bearings are freer than it reckons with, and which wheels slide that nothing else
/// knows of, keeps no base from parking.
#[test]
fn a_gyro_keeps_no_base_from_parking() -> Result<(), Box<dyn Error>> {
    let mut figures = Vec::new();
    for built_in in BASES {
        let base = built_in.with_gyro()?;
        let seeds = NonZeroU32::new(20).ok_or("0")?;
        let runs = verify(&base, KEPT_SEED, seeds, || {})?.runs;
        figures.extend([failing(&runs), runs.len() as f64]);
    }
    Stated::of("docs/gyro.md").exactly(
        At::Phrase("of the runs of the test # of # fail (30 kg), # of # (10 kg), # of # (1 kg)"),
        &figures,
    );
    Ok(())
}

/// Drivers that close their own speed loop around the shipped bases' motors.
#[test]
fn bases_with_speed_drivers_park_as_stated() -> Result<(), Box<dyn Error>> {
    let mut page = Stated::of("docs/your-robot.md");
    for built_in in BASES {
        let base = built_in.with_speed_driver()?;
        let seeds = NonZeroU32::new(10).ok_or("0")?;
        let runs = verify(&base, KEPT_SEED, seeds, || {})?.runs;
        let mut times: Vec<f64> = runs
            .iter()
            .filter(|run| run.course == Course::Park && run.figures.parked)
            .map(|run| run.figures.time_s)
            .collect();
        times.sort_by(f64::total_cmp);
        let half = times[times.len() / 2];
        let last = times[times.len() - 1];
        page.exactly(
            At::Row("Drivers with a speed loop", built_in.name),
            &[runs.len() as f64, failing(&runs), half, last],
        );
    }
    Ok(())
}

/// Neither bearings that are freer than any floor, so that what holds the wheels is stated by nobody, nor poses so precise that friction holds a base outside of its
/// tolerance; with gains that follow from the limits.
#[test]
fn friction_that_nobody_stated_keeps_no_base_from_parking() -> Result<(), Box<dyn Error>> {
    let free = ["static_nm", "coulomb_nm", "viscous_nm_s"].map(|key| ("friction", key, None));
    let precise = [
        ("rate_hz", 200.0),
        ("latency_s", 0.004),
        ("noise_m", 3.0e-4),
        ("noise_rad", 5.0e-4),
    ]
    .map(|(key, value)| ("pose_source", key, Some(value)));
    let mut page = Stated::of("docs/motion.md");
    for (row, changes) in [
        ("bearings with a twentieth of the friction", &free[..]),
        ("poses of 0.3 mm and 0.5 mrad, 200 a second", &precise[..]),
    ] {
        let (mut numbers, mut amiss, mut last) = (Vec::new(), Vec::new(), Vec::new());
        for built_in in BASES {
            let mut file: toml::Table = built_in.text.parse()?;
            file.remove("gains");
            for &(table, key, to) in changes {
                let table = file.get_mut(table).and_then(toml::Value::as_table_mut);
                let value = table.and_then(|table| table.get_mut(key)).ok_or(key)?;
                let stated = value.as_float().ok_or(key)?;
                *value = toml::Value::Float(to.unwrap_or(0.05 * stated));
            }
            let base = BaseSpec::parse("changed.toml", &file.to_string())?;
            let runs = verify(&base, KEPT_SEED, NonZeroU32::new(20).ok_or("0")?, || {})?.runs;
            let parked = |run: &&Run| run.course == Course::Park && run.figures.parked;
            let parks = runs.iter().filter(parked).map(|run| run.figures.time_s);
            numbers.push(runs.len() as f64);
            amiss.push(failing(&runs));
            last.push(parks.fold(0.0, f64::max));
        }
        page.exactly(
            At::Row("Friction that nobody stated", row),
            &[numbers, amiss, last].concat(),
        );
    }
    Ok(())
}

/// Wheels that differ by a hundredth turn the base by 0.1 rad on 4 m: without poses from outside nothing
/// corrects it.
#[test]
fn a_robot_that_does_not_know_where_it_is_fails() -> Result<(), Box<dyn Error>> {
    let mut base = base("hobby-1kg")?;
    base.hardware.as_mut().ok_or("no hardware")?.pose_source = None;
    let verification = verify(&base, 0, NonZeroU32::MIN, || {})?;
    let far = verification
        .runs
        .iter()
        .filter(|run| run.course != Course::Park);
    assert!(!verification.holds());
    for run in far {
        assert!(shortcoming(&run.figures).is_some(), "{run:?}");
    }
    Ok(())
}

#[test]
fn the_way_from_a_file_to_constants() -> Result<(), Box<dyn Error>> {
    let here = tempfile::tempdir()?;
    let text = BuiltInBase::find("hobby-1kg").ok_or("not built in")?.text;
    std::fs::write(here.path().join("My Robot.toml"), text)?;
    let tuned = sim_host(
        here.path(),
        &["tune", "My Robot.toml", "--evaluations", "4", "--write"],
    );
    assert!(tuned.status.success(), "{tuned:?}");
    let said = String::from_utf8(tuned.stdout)?;
    assert!(
        said.contains("unseen") && said.contains("[gains] of My Robot.toml"),
        "{said}"
    );
    let written = std::fs::read_to_string(here.path().join("My Robot.toml"))?;
    assert!(written.contains("# a small dual driver") && written.contains("approach = "));
    let verification = sim_host(here.path(), &["verify", "My Robot.toml", "--seeds", "1"]);
    let said = String::from_utf8(verification.stdout)?;
    let passed = said.contains("PASS:");
    assert!(passed != said.contains("FAIL:"), "{said}");
    assert_eq!(
        verification.status.code(),
        Some(i32::from(!passed)),
        "{said}"
    );
    for arguments in [
        &["constants", "My Robot.toml"][..],
        &["constants", "My Robot.toml", "--c"],
    ] {
        let constants = sim_host(here.path(), arguments);
        assert!(constants.status.success(), "{constants:?}");
    }
    for name in [
        "My Robot-tune.svg",
        "My Robot-tune.png",
        "My Robot-tune.json",
        "My Robot-verify.svg",
        "My Robot-verify.csv",
        "My Robot-verify.json",
        "My Robot-verify-worst.csv",
        "my_robot.rs",
        "my_robot.h",
    ] {
        assert!(here.path().join("out").join(name).exists(), "{name}");
    }
    // The old name of `verify` is there for one release more, and says so.
    let old = sim_host(here.path(), &["prove", "no robot.toml"]);
    let said = String::from_utf8(old.stderr)?;
    assert!(
        said.starts_with("note: `prove` is `verify`") && said.contains("no robot.toml"),
        "{said}"
    );
    // Built-in robots are known by name, but are nobody's to write to.
    let refused = sim_host(here.path(), &["tune", "lab-10kg", "--write"]);
    assert_eq!(refused.status.code(), Some(1));
    Ok(())
}

/// Runs that did not park have no time after which they did, and that is said in words.
#[test]
fn parks_that_never_happen_have_no_time() {
    let run = |parked, time_s| Run {
        course: Course::Line,
        condition: Condition::Drawn,
        seed: 1,
        figures: Figures {
            parked,
            time_s,
            error_m: 0.0,
            error_rad: 0.0,
            tracking_m: None,
            ripple: None,
            effort: 0.0,
            peak: None,
            stopped: None,
            found: Vec::new(),
        },
    };
    let text = verdict(&Verification {
        runs: vec![run(true, 8.0), run(true, 9.0), run(false, 60.0)],
        cases: Vec::new(),
    });
    let line = "half parked within 9.0 s, 99 % never, the last never";
    assert!(text.contains(line) && !text.contains("inf"), "{text}");
}
