//! Peers of the controller in the same harness: what two common filters and the laws of `sim-host bench` cost on the same
//! emulated chip.
//!
//! `cargo run --release` prints lines `name min mean max` of executed instructions; `--bin cost-stack` those of a whole stack.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod peers;

#[cfg(target_os = "none")]
mod rivals;

#[cfg(target_os = "none")]
firmware_demo::firmware!(peers::run);

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board: cargo run --release");
}
