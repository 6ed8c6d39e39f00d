//! The program, as a user starts it.

use std::path::Path;
use std::process::{Command, Output};

pub fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sim-host"))
}

/// What comes of these arguments in a directory.
pub fn sim_host(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = program();
    command.args(arguments).current_dir(directory);
    command.output().expect("the program runs")
}
