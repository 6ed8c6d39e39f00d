//! The robot that the boards drive: constants as `sim-host constants` writes them, named by `ROBOT` in a board's
//! `.cargo/config.toml`; without it `boards/robot.rs`.

use std::env;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-env-changed=ROBOT");
    let folder = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let robot =
        env::var_os("ROBOT").map_or_else(|| Path::new(&folder).join("../robot.rs"), PathBuf::from);
    // It is included from another folder.
    let robot = robot
        .canonicalize()
        .unwrap_or_else(|error| panic!("ROBOT = {}: {error}", robot.display()));
    println!("cargo::rerun-if-changed={}", robot.display());
    println!("cargo::rustc-env=ROBOT_CONSTANTS={}", robot.display());
}
