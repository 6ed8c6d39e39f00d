//! Desktop simulator around `controller-core`: see `sim-host --help`.

mod bench_args;
mod cli;
mod commands;
mod drive_args;
mod log_args;
mod part_args;
mod robot_args;
mod seed_args;

use clap::{Arg, Command, CommandFactory, FromArgMatches};
use std::error::Error as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    // A usage error ends the process here, with exit code 2.
    let matches = numbers(<cli::Cli as CommandFactory>::command()).get_matches();
    let cli = cli::Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match commands::execute(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let mut text = String::new();
            for error in error.each() {
                text += &format!("error: {error}\n");
                let mut cause = error.source();
                while let Some(inner) = cause {
                    text += &format!("  because: {inner}\n");
                    cause = inner.source();
                }
            }
            commands::tell(&text);
            ExitCode::FAILURE
        }
    }
}

/// A number below 0 is the value of the option before it, and refused as that; else it would be called an unknown option.
fn numbers(command: Command) -> Command {
    let takes = |arg: &Arg| !arg.is_positional() && arg.get_action().takes_values();
    command
        .mut_args(|arg| match takes(&arg) {
            true => arg.allow_negative_numbers(true),
            false => arg,
        })
        .mut_subcommands(numbers)
}
