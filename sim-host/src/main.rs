//! Desktop simulator around `controller-core`: see `sim-host --help`.

mod bench_args;
mod cli;
mod commands;
mod count_args;
mod drive_args;
mod log_args;
mod part_args;
mod robot_args;
mod seed_args;

use clap::{Arg, Command, CommandFactory, FromArgMatches};
use sim_host::plain_text::written_out;
use std::error::Error;
use std::ffi::OsString;
use std::process::ExitCode;

fn main() -> ExitCode {
    // A usage error ends the process here, with exit code 2.
    let cli = arguments().unwrap_or_else(|error| error.exit());
    match commands::execute(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let told: String = error.each().iter().map(|error| told(error)).collect();
            commands::tell(&told);
            ExitCode::FAILURE
        }
    }
}

/// An error with its causes, those that it does not say itself.
fn told(error: &dyn Error) -> String {
    let mut text = format!("error: {error}\n");
    let mut cause = error.source();
    while let Some(inner) = cause {
        let why = inner.to_string();
        if !text.contains(&why) {
            text += &format!("  because: {why}\n");
        }
        cause = inner.source();
    }
    text
}

/// What was typed. A refusal repeats it, and a terminal would obey its control signs: what is refused is parsed again with these written
/// out, for what clap says of it.
fn arguments() -> Result<cli::Cli, clap::Error> {
    let typed: Vec<OsString> = std::env::args_os().collect();
    parse(typed.clone()).map_err(|refusal| {
        let harmless = typed
            .iter()
            .map(|argument| written_out(&argument.to_string_lossy()).into());
        // What is refused for no other reason than that it is not UTF-8 is not repeated.
        parse(harmless.collect()).err().unwrap_or(refusal)
    })
}

fn parse(arguments: Vec<OsString>) -> Result<cli::Cli, clap::Error> {
    let matches =
        numbers(<cli::Cli as CommandFactory>::command()).try_get_matches_from(arguments)?;
    cli::Cli::from_arg_matches(&matches)
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
