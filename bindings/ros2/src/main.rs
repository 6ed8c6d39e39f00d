//! A bridge between a base at the end of a serial line and ROS 2; `docs/ros2.md` has topics, services and safety.

#![forbid(unsafe_code)]

mod args;
mod bridge;
mod clock;
mod course;
mod lifecycle;
mod node;
mod run;
mod wheels;

use clap::Parser;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn main() -> ExitCode {
    let args = args::Args::parse();
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        if let Err(error) = signal_hook::flag::register(signal, Arc::clone(&stop)) {
            eprintln!("signals: {error}");
            return ExitCode::FAILURE;
        }
    }
    match run::run(&args, &stop) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
