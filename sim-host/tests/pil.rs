//! `sim-host pil` from outside. The emulator is part of the test: it is not skipped without it.

use crate::program::{program, sim_host};
use controller_core::base::BaseParams;
use controller_core::types::Pose;
use firmware_demo::host::{Image, Machine, build_image};
use protocol::pil::{BaseInput, BaseTicked, WheelOutput};
use protocol::{Command as Order, RejectReason};
use serde_json::Value;
use sim_host::closed_loop::{Mirror, MirrorError};
use sim_host::csv_out::Columns;
use sim_host::mission::Mission;
use sim_host::run::fly;
use sim_host::scenario::{BuiltInBase, SPEED_DRIVER};
use sim_host::verify::{DISTANCE_M, HEADING_RAD};
use std::fs;
use std::path::Path;
use std::process::Output;

/// Short, with a hand-over, other parking gains and a torque limit.
const MINE: &str = "\
description = \"mine\"
[run]
duration = 1.0
period = 0.005
[gains]
kc1 = 150.0
[robot]
max_wheel_torque = 1.0
[start]
y = 0.3
[reference]
v = 0.4
[hand_over]
time = 0.5
target_at = 0.8
";

fn pil(directory: &Path, arguments: &[&str]) -> Output {
    sim_host(directory, &[&["pil"], arguments].concat())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> Value {
    let text = fs::read_to_string(path).expect("metrics");
    let mut records: Value = serde_json::from_str(&text).expect("JSON");
    records[0].take()
}

#[test]
fn a_scenario_is_flown_by_the_chip_bit_for_bit() {
    let here = tempfile::tempdir().expect("a directory");
    fs::write(here.path().join("mine.toml"), MINE).expect("written");
    let output = pil(here.path(), &["mine.toml", "--every", "10"]);
    let (shown, said) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{said}");
    for part in [
        "bit-equal",
        "instructions per tick",
        "hand-over",
        "of stack",
        "ticks/s",
    ] {
        assert!(shown.contains(part), "{part} is not in\n{shown}");
    }
    assert!(
        said.contains("the chip runs precision f32, maths single"),
        "{said}"
    );

    let out = here.path().join("out");
    let record = json(&out.join("mine-pil.json"));
    let chip = &record["chip"];
    assert_eq!(record["controller"]["maths"], "single");
    assert_eq!(chip["machine"], "Cortex-M4F");
    assert_eq!(chip["parity"]["ticks"], 201);
    assert_eq!(chip["parity"]["bits_apart"], 0);
    let count = |phase: &str, key: &str| chip["instructions"][phase][key].as_u64();
    for (phase, ticks) in [
        ("start", 1),
        ("tracking", 99),
        ("hand_over", 1),
        ("parking", 100),
    ] {
        assert_eq!(count(phase, "ticks"), Some(ticks), "{phase}");
        let least = count(phase, "least").expect("a number");
        let most = count(phase, "most").expect("a number");
        assert!((50..=2000).contains(&least) && most >= least, "{phase}");
    }
    let size = |key: &str| chip["image"][key].as_u64().expect("a number");
    assert!((2_000..100_000).contains(&size("text")) && size("rodata") > 0);
    assert!(size("data") + size("bss") < 32_768);
    let stack = chip["stack_bytes"].as_u64().expect("a number");
    assert!((256..8192).contains(&stack), "{stack}");

    let rows = fs::read_to_string(out.join("mine-pil.csv")).expect("CSV");
    assert_eq!(rows.lines().count(), 1 + 21);
    assert!(
        fs::read(out.join("mine-pil.png"))
            .expect("a figure")
            .starts_with(b"\x89PNG")
    );
    let svg = fs::read_to_string(out.join("mine-pil.svg")).expect("a figure");
    assert!(svg.contains("Cortex-M4F"));

    // The same numbers as a run of the same controller here: not only ticks, the whole flight.
    let single = format!(
        "{MINE}[controller]\nprecision = \"f32\"\nmaths = \"single\"\nneurons = \"rational-mean\"\n"
    );
    let single = sim_host::scenario::Scenario::parse("mine.toml", &single).expect("in order");
    let trace = sim_host::run::run(&single).expect("no fault");
    let mut expected = Vec::new();
    sim_host::csv_out::write(&trace, Columns::Paper, 10, &mut expected).expect("written");
    assert_eq!(rows, text(&expected));
}

#[test]
fn riscv_over_the_serial_port_does_the_same() {
    let here = tempfile::tempdir().expect("a directory");
    let mine = MINE.replace("duration = 1.0", "duration = 0.6");
    fs::write(here.path().join("mine.toml"), mine).expect("written");
    let arguments = ["mine.toml", "--machine", "riscv32", "--link", "uart"];
    let output = pil(here.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record = json(&here.path().join("out/mine-pil.json"));
    assert_eq!(record["chip"]["machine"], "riscv32imafc");
    assert_eq!(record["chip"]["link"], "uart");
    assert_eq!(record["chip"]["parity"]["ticks"], 121);
    assert_eq!(record["chip"]["parity"]["ticks_apart"], 0);
}

#[test]
fn what_the_firmware_does_not_have_is_refused_with_the_reason() {
    let here = tempfile::tempdir().expect("a directory");
    let plain = format!("{MINE}[controller]\nkind = \"plain\"\n");
    fs::write(here.path().join("plain.toml"), plain).expect("written");
    let output = pil(here.path(), &["plain.toml"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said.contains("plain: the firmware has the neural law"),
        "{said}"
    );
    assert!(said.contains("sim-host run"), "{said}");
}

#[test]
fn a_missing_emulator_is_named_with_its_package() {
    let here = tempfile::tempdir().expect("a directory");
    // Before: what builds it may be in the emulator's folder.
    let firmware = Image {
        machine: Machine::CortexM4F,
        bin: "pil",
        features: "panic-proof",
    };
    build_image(&firmware).expect("the firmware builds");
    let path = std::env::var("PATH").expect("a path");
    // The tools of Rust, without the emulator.
    let tools: Vec<_> = std::env::split_paths(&path)
        .filter(|directory| !directory.join("qemu-system-arm").exists())
        .collect();
    let output = program()
        .args(["pil", "paper-line"])
        .current_dir(here.path())
        .env("PATH", std::env::join_paths(tools).expect("a path"))
        // A test that cargo runs has this variable; it need not be on the path that is left.
        .env("CARGO", std::env::var_os("CARGO").expect("run by cargo"))
        .output()
        .expect("the program runs");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said.contains("apt-get install -y --no-install-recommends qemu-system-arm"),
        "{said}"
    );
}

/// A base on a floor with friction, late noisy poses and uneven ticks; the numbers are of no importance, only that each acts.
const FLOOR: &str = "\
description = \"a base on a floor\"
base = \"hobby-1kg\"
[run]
duration = 4.0
period = 0.005
[controller]
kind = \"motion\"
[start]
y = 0.05
[goal]
x = 0.3
[world]
[world.body]
mass_factor = 1.2
[world.floor]
mu = 0.7
[world.pose_source]
rate_hz = 20.0
latency_s = 0.05
noise_m = 0.002
noise_rad = 0.003
";

/// Flies `floor.toml`, of which every number is the same here: what the record says, and how many ticks were flown.
fn flown_bit_for_bit(here: &Path, machine: &str) -> (Value, u64) {
    let output = pil(here, &["floor.toml", "--machine", machine]);
    let shown = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(shown.contains("bit-equal to the host: 0 of"), "{shown}");
    let record = json(&here.join("out/floor-pil.json"));
    let parity = &record["chip"]["parity"];
    // 28 numbers of each.
    let flown = parity["ticks"].as_u64().expect("a number");
    assert_eq!(parity["numbers"], flown * 28);
    assert_eq!(parity["numbers_apart"], 0);
    (record, flown)
}

/// What the chip drove of `floor.toml` is what `run` shows.
fn is_that_of_run(here: &Path) {
    let flown = fs::read_to_string(here.join("out/floor-pil.csv")).expect("CSV");
    let arguments = ["run", "floor.toml", "--csv", "--out", "here"];
    let output = sim_host(here, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let simulated = fs::read_to_string(here.join("here/floor.csv")).expect("CSV");
    assert!(flown == simulated, "the chip's run is not that of `run`");
}

/// The control task on the chip and the one here do the same in every bit, and what the chip drove is what `run` shows.
#[test]
fn the_whole_base_is_flown_bit_for_bit() {
    let here = tempfile::tempdir().expect("a directory");
    fs::write(here.path().join("floor.toml"), FLOOR).expect("written");
    for machine in ["cortex-m4f", "riscv32"] {
        let (record, flown) = flown_bit_for_bit(here.path(), machine);
        // 4 s of 5 ms at most, first and last included; a base that parked sooner is flown a second longer.
        assert!((400..=801).contains(&flown), "{flown}");
        let chip = &record["chip"];
        let states = chip["instructions"].as_object().expect("by state");
        let ticks = |state: &str| states.get(state).and_then(|cost| cost["ticks"].as_u64());
        let all: u64 = states
            .values()
            .filter_map(|cost| cost["ticks"].as_u64())
            .sum();
        assert_eq!((all, ticks("other")), (flown, Some(1)));
        assert!(ticks("parking") > Some(flown / 2), "{states:?}");
        let least = chip["instructions"]["parking"]["least"].as_u64();
        assert!(least.is_some_and(|count| (1_000..20_000).contains(&count)));
    }
    is_that_of_run(here.path());
}

/// What the wheels get of a base here, tick by tick.
#[derive(Default)]
struct Outputs(Vec<WheelOutput>);

impl Mirror for Outputs {
    fn begin(&mut self, _: &BaseParams<f32>, _: Pose<f32>) -> Result<(), MirrorError> {
        Ok(())
    }

    fn command(&mut self, _: &Order, _: Result<(), RejectReason>) -> Result<(), MirrorError> {
        Ok(())
    }

    fn tick(&mut self, _: &BaseInput, here: &BaseTicked) -> Result<WheelOutput, MirrorError> {
        self.0.push(here.output);
        Ok(here.output)
    }
}

/// A base whose file has a `[speed_driver]`: the chip commands speeds, the same bits as here, and parks by them.
#[test]
fn a_base_with_speed_drivers_is_flown_bit_for_bit() {
    let here = tempfile::tempdir().expect("a directory");
    let lab = BuiltInBase::find("lab-10kg").expect("built in");
    let robot = format!("{}\n{SPEED_DRIVER}", lab.text);
    fs::write(here.path().join("robot.toml"), robot).expect("written");
    let floor = FLOOR.replace("hobby-1kg", "robot.toml");
    let scenario = here.path().join("floor.toml");
    fs::write(&scenario, &floor).expect("written");
    let (record, flown) = flown_bit_for_bit(here.path(), "cortex-m4f");
    assert_eq!(record["base"], "10 kg lab base");
    assert!((400..=801).contains(&flown), "{flown}");
    let parking = &record["chip"]["instructions"]["parking"]["ticks"];
    assert!(parking.as_u64() > Some(flown / 2), "{parking}");
    let metrics = &record["metrics"];
    assert_eq!(metrics["outcome"], "parked");
    let figure = |part: &str, key: &str| metrics["run"][part][key].as_f64().expect("a number");
    let distance_m = figure("final_error", "position_m");
    let heading_rad = figure("final_error", "e_theta_rad");
    assert!(distance_m < DISTANCE_M, "{distance_m}");
    assert!(heading_rad.abs() < HEADING_RAD, "{heading_rad}");
    is_that_of_run(here.path());

    // The kind of output and both of its numbers are among what is equal in every tick: what is put out here went over the wire.
    let mission = Mission::parse(scenario.to_str().expect("a path"), &floor).expect("in order");
    let setup = mission.setup.clone().expect("a world");
    let mut outputs = Outputs::default();
    fly(&mission, &setup, &mut outputs, None).expect("it runs");
    assert_eq!(outputs.0.len() as u64, flown);
    // Released until it is armed, and speeds in every tick from then on.
    let (first, driven) = outputs.0.split_first().expect("ticks");
    assert_eq!(*first, WheelOutput::Release);
    let fastest = driven.iter().fold(0.0_f32, |fastest, output| {
        let WheelOutput::Speed { right, left } = output else {
            panic!("{output:?} in place of speeds");
        };
        fastest.max(0.5 * (right + left))
    });
    // As fast as the base went.
    let rim = f64::from(fastest) * mission.base.robot.wheels.radius_right_m;
    let peak = figure("speed_m_s", "peak");
    assert!(peak > 0.3 && (rim / peak - 1.0).abs() < 0.1, "{rim} {peak}");
}

/// A trajectory file with a base's file, and a scenario of the paper's law, in one call.
#[test]
fn files_and_laws_are_flown_together() {
    let here = tempfile::tempdir().expect("a directory");
    let mine = MINE.replace("duration = 1.0", "duration = 0.6");
    fs::write(here.path().join("mine.toml"), mine).expect("written");
    let file = tests::fixtures::path("small_wpilib.json");
    let file = file.to_str().expect("a path");
    let output = pil(here.path(), &["mine.toml", file, "--base", "lab-10kg"]);
    let shown = text(&output.stdout);
    assert!(output.status.success(), "{shown}{}", text(&output.stderr));
    assert_eq!(shown.matches("bit-equal to the host: 0 of").count(), 2);
    let record = json(&here.path().join("out/small_wpilib-pil.json"));
    assert_eq!(record["base"], "10 kg lab base");
    assert_eq!(record["chip"]["parity"]["bits_apart"], 0);
    let following = &record["chip"]["instructions"]["following"]["ticks"];
    assert!(following.as_u64().is_some_and(|ticks| ticks > 100));
}
