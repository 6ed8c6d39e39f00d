//! Lets the linker find the memory map of this folder.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=memory.x");
    let folder = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    println!("cargo::rustc-link-search={folder}");
}
