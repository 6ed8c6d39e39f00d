//! Links a program that panics, or one that does not, against the firmware's proof that no panic is reachable.

use std::fs;
use std::process::Command;

use super::budget_image::{BOARDS, cargo, root, target_dir};

/// A program around the firmware's entry and panic handler; its index is not known before it runs.
const PROGRAM: &str = r#"#![no_std]
#![no_main]
use core::hint::black_box;
firmware_demo::firmware!(run);
fn run() {
    let values = black_box([1_u32, 2, 3]);
    black_box(INDEX);
}
"#;

/// Builds [`PROGRAM`] with an index in place; the answer is what the linker said.
pub fn link(level: &str, index: &str) -> (bool, String) {
    let folder = target_dir(level).join("panic-proof-program");
    fs::create_dir_all(folder.join("src")).expect("a folder can be made");
    let firmware = root()
        .join("firmware-demo")
        .canonicalize()
        .expect("firmware-demo is there");
    let firmware = firmware.display();
    let manifest = format!(
        "[package]\nname = \"program\"\nversion = \"0.0.0\"\nedition = \"2024\"\n[workspace]\n\
         [dependencies]\ncortex-m-rt = \"0.7.5\"\n\
         firmware-demo = {{ path = \"{firmware}\", features = [\"panic-proof\"] }}\n\
         [profile.chip]\ninherits = \"release\"\nlto = \"fat\"\ncodegen-units = 1\npanic = \"abort\"\n"
    );
    let write = |name: &str, text: &[u8]| {
        fs::write(folder.join(name), text).expect("a file can be written")
    };
    write("Cargo.toml", manifest.as_bytes());
    write("src/main.rs", PROGRAM.replace("INDEX", index).as_bytes());
    // The same versions, and no question to the registry.
    write(
        "Cargo.lock",
        &fs::read(root().join("Cargo.lock")).expect("the lock file is there"),
    );
    write(
        "memory.x",
        &fs::read(root().join("firmware-demo/memory/mps2-an386.x")).expect("the map is there"),
    );
    let mut command: Command = cargo(&folder, level);
    command
        .args([
            "build",
            "--quiet",
            "--profile",
            "chip",
            "--target",
            BOARDS[0].target,
        ])
        .env(
            "RUSTFLAGS",
            format!(
                "-Clink-arg=-L{} -Clink-arg=--nmagic -Clink-arg=-Tlink.x",
                folder.display()
            ),
        );
    let output = command.output().expect("cargo can be started");
    (
        output.status.success(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}
