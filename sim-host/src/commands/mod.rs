//! What each command does.

mod compare;
mod constants;
mod drive;
mod error;
mod faults;
mod identify;
mod job;
mod list;
mod monitor;
mod pil;
mod prove;
mod robot;
mod robustness;
mod run;
mod tune;
mod write;

use crate::cli::{Cli, Command};
use error::CommandError;
use sim_host::advice::warnings;
use sim_host::metrics::Metrics;
use sim_host::scenario::{BuiltIn, PAPER, Scenario};
use sim_host::trace::Trace;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Does what the arguments say.
pub fn execute(cli: &Cli) -> Result<(), CommandError> {
    let output = cli.output();
    match cli.command() {
        Command::Paper => compare::paper(&PAPER, output),
        Command::Run { files, csv, drive } => {
            let base = drive::base(drive.base.as_deref())?;
            let jobs = drive::load_all(files, &drive.file_run(), &base)?;
            run::all(&jobs, *csv, output)
        }
        Command::Check(arguments) => drive::check(arguments),
        Command::Compile(arguments) => drive::compile(arguments, output),
        Command::Compare { files, csv } => compare::scenarios(&load_all(files)?, *csv, output),
        Command::Pil {
            files,
            machine,
            link,
        } => {
            let scenarios = match files.as_slice() {
                [] => load_all(&PAPER.map(PathBuf::from))?,
                files => load_all(files)?,
            };
            pil::all(&scenarios, (*machine).into(), (*link).into(), output)
        }
        Command::Robustness { seeds, only } => robustness::all(*seeds, only, output),
        Command::Faults {
            runs,
            seed,
            only,
            run,
        } => faults::all(*runs, seed.draw()?, only, *run, output),
        Command::Prove(arguments) => prove::robot(arguments, output),
        Command::Constants(arguments) => constants::write(arguments, output),
        Command::Tune(arguments) => tune::robot(arguments, output),
        Command::Monitor(arguments) => monitor::listen(arguments),
        Command::Identify(arguments) => identify::run(arguments, output),
        Command::List { directory } => list::list(directory.as_deref()),
        Command::Show { name } => list::show(name),
    }
}

/// A scenario that has been run.
struct Finished {
    scenario: Scenario,
    trace: Trace,
    metrics: Metrics,
}

fn load_all(files: &[PathBuf]) -> Result<Vec<Scenario>, CommandError> {
    let mut scenarios: Vec<Scenario> = Vec::new();
    for file in files {
        let scenario = load(file)?;
        // Results are named after the file: a second one would overwrite the first one's.
        if scenarios.iter().any(|other| other.name == scenario.name) {
            return Err(CommandError::SameName(scenario.name));
        }
        scenarios.push(scenario);
    }
    Ok(scenarios)
}

/// A file if there is one, else a built-in scenario of that name.
fn load(file: &Path) -> Result<Scenario, CommandError> {
    let built_in = file.to_str().and_then(BuiltIn::find);
    match built_in {
        Some(built_in) if !file.exists() => Ok(built_in.scenario()?),
        _ => Ok(Scenario::load(file)?),
    }
}

fn simulate(scenario: &Scenario) -> Result<Finished, CommandError> {
    let trace = sim_host::run::run(scenario)?;
    let metrics = Metrics::of(&trace).ok_or(CommandError::NoRows)?;
    Ok(Finished {
        scenario: scenario.clone(),
        trace,
        metrics,
    })
}

/// Prints to standard output. A reader that has seen enough (`| head`) does not keep the results
/// from being written.
fn say(text: &str) -> Result<(), CommandError> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CommandError::Print(error)),
        _ => Ok(()),
    }
}

/// Prints warnings to standard error, where they do not disturb a table in a pipe.
fn warn(scenario: &Scenario) {
    for warning in warnings(scenario) {
        // Nobody to warn is no reason to stop.
        let _ = writeln!(std::io::stderr(), "warning: {}: {warning}", scenario.name);
    }
}
