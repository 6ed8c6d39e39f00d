//! The law for a real base on emulated chips: a trajectory file, compiled to a table in flash, driven to parked,
//! with the same bits as on the host.

use firmware_demo::host::{Image, Machine, build_image};
use firmware_demo::route::{BEND, Driven, base, drive};
use std::collections::BTreeMap;
use std::process::Command;

/// As the image does: the route, and time to park.
const TICKS: u32 = 14_000;

/// The same mission in this process.
fn on_host() -> Driven {
    let base = base().expect("the base is in order");
    drive(&BEND, &base, TICKS, |controller, dt, task, measured| {
        controller.step(dt, task, measured).map(|_| ())
    })
    .expect("no fault")
}

/// The image's lines, `name number` or `name min mean max`, by their last number.
fn on_chip(machine: Machine, emulator: &[&str]) -> BTreeMap<String, f64> {
    let image = build_image(&Image {
        machine,
        bin: "route",
        features: "panic-proof",
    })
    .expect("the image links without a reachable panic");
    let (program, arguments) = emulator.split_first().expect("an emulator has a name");
    let output = Command::new(program)
        .args(arguments)
        .args(["-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .arg("-kernel")
        .arg(&image)
        .output()
        .unwrap_or_else(|error| {
            panic!(
                "{program}: {error}; `sh tests/run` installs qemu-system-arm and qemu-system-misc"
            )
        });
    // Semihosting prints on the standard error stream of some emulators.
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    println!("{machine:?}:\n{text}");
    text.lines()
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            let name = words.next()?;
            let last = words.last()?.parse().ok()?;
            Some((name.to_owned(), last))
        })
        .collect()
}

fn assert_same(chip: &BTreeMap<String, f64>) {
    let host = on_host();
    for (name, expected) in [
        ("ticks", host.ticks),
        ("handed-over", host.handed_over),
        ("parked", host.parked),
        ("checksum", host.checksum),
    ] {
        assert_eq!(chip.get(name), Some(&f64::from(expected)), "{name}");
    }
}

/// Hands over by itself, parks before the end, and stays.
#[test]
fn route_from_flash_ends_parked() {
    let host = on_host();
    println!("{host:?}");
    assert_eq!(host.ticks, TICKS);
    assert!(host.handed_over > 0 && host.parked > host.handed_over);
    assert!(
        host.parked < TICKS - 500,
        "parked for half a second at least"
    );
}

/// 84,000 torques, commands and wishes: one checksum. What a tick
/// costs is printed, and held to what a 1 kHz tick on a 100 MHz chip has to spare: 2.5 %, of which the disturbance
/// estimate and the watch over retries take some tenths.
#[test]
fn cortex_m4f_drives_the_route_bit_for_bit() {
    let chip = on_chip(
        Machine::CortexM4F,
        &["qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=10"],
    );
    assert_same(&chip);
    for phase in ["motion/follow", "motion/park"] {
        let most = chip.get(phase).expect("the image counts");
        assert!(*most <= 2500.0, "{phase}: {most} instructions");
    }
}

/// The same on another instruction set.
#[test]
fn riscv_drives_the_route_bit_for_bit() {
    let machine = ["qemu-system-riscv32", "-M", "virt", "-bios", "none"];
    let chip = on_chip(
        Machine::Riscv32,
        &[&machine[..], &["-icount", "shift=0"]].concat(),
    );
    assert_same(&chip);
}
