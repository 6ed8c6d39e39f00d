//! Links a program that panics, or one that does not, against the firmware's proof that no panic is reachable.

use std::fs;

use super::budget_image::{Board, cargo, root, target_dir};

/// Around the firmware's entry and panic handler.
const FRAME: &str = r#"#![no_std]
#![no_main]
use core::hint::black_box;
firmware_demo::firmware!(run);
"#;

/// Builds a program of these items, among them `fn run()`, with further arguments for the compiler; the answer is what the
/// linker said.
pub fn link(board: Board, level: &str, items: &str, arguments: &[&str]) -> (bool, String) {
    let folder = target_dir(level)
        .join("panic-proof-program")
        .join(board.name);
    fs::create_dir_all(folder.join("src")).expect("a folder can be made");
    let root = root().canonicalize().expect("the workspace is there");
    let workspace = root.display();
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
    let manifest = format!(
        "[package]\nname = \"program\"\nversion = \"0.0.0\"\nedition = \"2024\"\n[workspace]\n\
         [dependencies]\n{run_time}\nheapless = {{ version = \"0.9.3\", default-features = false }}\n\
         controller-core = {{ path = \"{workspace}/controller-core\" }}\n\
         firmware-demo = {{ path = \"{workspace}/firmware-demo\", features = [\"panic-proof\"] }}\n\
         protocol = {{ path = \"{workspace}/protocol\", package = \"controller-core-protocol\" }}\n\
         [profile.release]\ndebug = \"line-tables-only\"\n\
         [profile.chip]\ninherits = \"release\"\nlto = \"fat\"\ncodegen-units = 1\npanic = \"abort\"\n"
    );
    let write = |name: &str, text: &[u8]| {
        fs::write(folder.join(name), text).expect("a file can be written")
    };
    let read = |name: &str| fs::read(root.join(name)).expect("a file of the workspace");
    write("Cargo.toml", manifest.as_bytes());
    write("src/main.rs", format!("{FRAME}{items}").as_bytes());
    // The same versions, and no question to the registry.
    write("Cargo.lock", &read("Cargo.lock"));
    let memory = read(&format!("firmware-demo/memory/{map}"));
    let memory = String::from_utf8(memory).expect("text");
    // Nothing runs: all functions there are need more room than a chip has.
    let memory = memory
        .replace("512K", "4M")
        .replace("0x80080000", "0x80400000");
    write("memory.x", memory.as_bytes());
    let search = format!("-L{}", folder.display());
    flags.push(&search);
    let flags = flags.iter().map(|flag| format!("-Clink-arg={flag}"));
    // For the program alone: with the workspace's profile, its dependencies are those of the images.
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
