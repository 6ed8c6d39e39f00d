//! The least that drives a two-wheeled robot along a trajectory, as WPILib's classes do it: odometry, Ramsete, and for each wheel a
//! PID with feed-forward. From encoder counts to duties, with the maths of the core.
//!
//! An image of its own: what a law costs depends a little on what else calls it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(stack::run);

#[cfg(target_os = "none")]
mod stack;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board: cargo run --release --bin cost-stack");
}
