//! The robot that the boards drive: constants as `sim-host constants` writes them, named by `ROBOT` in a board's
//! `.cargo/config.toml`; without it `boards/robot.rs`.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-env-changed=ROBOT");
    let folder = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let robot =
        env::var_os("ROBOT").map_or_else(|| Path::new(&folder).join("../robot.rs"), PathBuf::from);
    println!("cargo::rerun-if-changed={}", robot.display());
    let text = fs::read_to_string(&robot)
        .unwrap_or_else(|error| panic!("ROBOT = {}: {error}", robot.display()));
    // Comments on the file itself have no place in the middle of another.
    let text = text.replace("//!", "//");
    let out = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    fs::write(Path::new(&out).join("robot.rs"), text).expect("OUT_DIR is there to be written");
}
