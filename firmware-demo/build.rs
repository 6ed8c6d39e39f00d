//! Memory maps of the emulated boards, for this package's binaries only: a board crate that uses the library
//! brings its own.

use std::env;
use std::fs;
use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=memory");
    let target_os = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if target_os != "none" {
        return;
    }
    let arch = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let (map, arguments): (_, &[&str]) = match arch.as_str() {
        "arm" => ("memory/mps2-an386.x", &["--nmagic", "-Tlink.x"]),
        "riscv32" => ("memory/virt.x", &["-Tmemory.x", "-Tlink.x"]),
        _ => return,
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(map, out.join("memory.x")).expect("the memory map can be copied");
    println!("cargo::rustc-link-arg-bins=-L{}", out.display());
    for argument in arguments {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
