//! Links a program that panics, or one that does not, against the firmware's proof that no panic is reachable.

use std::fs;
use std::sync::{Mutex, PoisonError};

use super::budget_image::{Board, cargo, root, target_dir};
use tests::program::package;

/// Around the firmware's entry and panic handler.
const FRAME: &str = r#"#![no_std]
#![no_main]
use core::hint::black_box;
firmware_demo::firmware!(run);
"#;

/// Builds a program of these items, among them `fn run()`, with further arguments for the compiler; the answer is what the
/// linker said.
pub fn link(board: Board, level: &str, items: &str, arguments: &[&str]) -> (bool, String) {
    // Tests run side by side, and all programs of a board and a level are at the same place.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = target_dir(level)
        .join("panic-proof-program")
        .join(board.name);
    let (run_time, map, mut flags) = match board.machine {
        "arm" => (
            "cortex-m-rt = \"0.7.5\"",
            "mps2-an386.x",
            vec!["--nmagic", "-Tlink.x"],
        ),
        _ => (
            "riscv-rt = { version = \"0.16\", features = [\"single-hart\"] }",
            "virt.x",
            vec!["-Tmemory.x", "-Tlink.x"],
        ),
    };
    let dependencies = format!(
        "{run_time}\nheapless.workspace = true\ncontroller-core.workspace = true\nprotocol.workspace = true\n\
         firmware-demo = {{ workspace = true, features = [\"panic-proof\"] }}"
    );
    package(&folder, "program", &dependencies);
    let write =
        |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file can be written");
    write("src/main.rs", &format!("{FRAME}{items}"));
    let memory = fs::read_to_string(root().join("firmware-demo/memory").join(map));
    let memory = memory.expect("a file of the workspace");
    // Nothing runs: all functions there are need more room than a chip has.
    let memory = memory
        .replace("512K", "4M")
        .replace("0x80080000", "0x80400000");
    write("memory.x", &memory);
    let search = format!("-L{}", folder.display());
    flags.push(&search);
    let flags = flags.iter().map(|flag| format!("-Clink-arg={flag}"));
    // For the program alone: its dependencies are those of the images.
    let output = cargo(&folder, level)
        .args(["rustc", "--quiet", "--profile", "chip", "--target"])
        .args([board.target, "--"])
        .args(flags)
        .args(arguments)
        .output()
        .expect("cargo can be started");
    (
        output.status.success(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}
