//! Tells the archives' builder which machine it is built for.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!(
        "cargo::rustc-env=TARGET={}",
        env::var("HOST").expect("cargo sets HOST")
    );
}
