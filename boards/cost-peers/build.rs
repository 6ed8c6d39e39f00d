//! The memory map of the emulated board, from the firmware's own.

use std::env;
use std::fs;
use std::path::PathBuf;

const MAP: &str = "../../firmware-demo/memory/mps2-an386.x";

fn main() {
    println!("cargo::rerun-if-changed={MAP}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(MAP, out.join("memory.x")).expect("the memory map can be copied");
    println!("cargo::rustc-link-arg-bins=-L{}", out.display());
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
