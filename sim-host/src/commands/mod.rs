//! What each command does.

mod bench;
mod compare;
mod constants;
mod drive;
mod error;
mod faults;
mod identify;
mod identify_live;
mod list;
mod log;
mod merge;
mod monitor;
mod part;
mod pil;
mod robot;
mod robustness;
mod run;
mod teleop;
mod tune;
mod verify;
mod write;

use crate::cli::{Cli, Command, LawArg};
use error::CommandError;
use sim_host::advice::{Advice, of_base, of_mission};
use sim_host::campaign::{Campaign, Robots};
use sim_host::datalog::check_name;
use sim_host::job::Trajectory;
use sim_host::mission::Mission;
use sim_host::plain_text::written_out;
use sim_host::record::Finished;
use sim_host::robustness::Robustness;
use sim_host::scenario::{PAPER, Scenario};
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;

/// Does what the arguments say.
pub fn execute(cli: &Cli) -> Result<(), CommandError> {
    let output = cli.output();
    if let Some(log) = cli.log() {
        // Before anything runs: some know only at the end of which run it is.
        check_name(log)?;
    }
    match cli.command() {
        Command::Paper => compare::paper(&PAPER, output),
        Command::Run {
            files,
            csv,
            log,
            drive,
        } => {
            let base = drive::base(drive.base.as_deref())?;
            let jobs = drive::load_all(files, drive, &base, false)?;
            run::all(&jobs, *csv, log, output)
        }
        Command::Check(arguments) => drive::check(arguments),
        Command::Compile(arguments) => drive::compile(arguments, output),
        Command::Compare {
            files,
            laws,
            csv,
            drive,
        } => {
            let base = drive::base(drive.base.as_deref())?;
            let by_base = laws.contains(&LawArg::Motion);
            let jobs = drive::load_all(files, drive, &base, by_base)?;
            let chosen = drive.base.as_ref().map(|_| &base);
            compare::jobs(&jobs, laws, chosen, *csv, output)
        }
        Command::Pil {
            files,
            machine,
            link,
            log,
            drive,
        } => {
            let base = drive::base(drive.base.as_deref())?;
            let jobs = match files.as_slice() {
                [] => drive::load_all(&PAPER.map(PathBuf::from), drive, &base, false)?,
                files => drive::load_all(files, drive, &base, false)?,
            };
            let board = pil::Board {
                machine: (*machine).into(),
                link: (*link).into(),
            };
            pil::all(&jobs, board, log, output)
        }
        Command::Robustness { seeds, only, part } => {
            let study = Robustness {
                seeds: *seeds,
                only: only.clone(),
            };
            robustness::all(&study, part, output)
        }
        Command::Faults {
            robot,
            runs,
            seed,
            only,
            run,
            gyro,
            log,
            part,
        } => {
            let robot = match robot {
                Some(path) => Some((robot::load(path)?, path.clone())),
                None => None,
            };
            let campaign = Campaign {
                on: Robots::of(robot, *gyro)?,
                runs: runs.get(),
                seed: part::seed(seed, part)?,
                only: only.clone(),
                first: run.unwrap_or(0),
            };
            faults::all(&campaign, (*run, log), part, output)
        }
        Command::Merge(arguments) => merge::merge(arguments, output),
        Command::Bench(arguments) => bench::bench(arguments, cli.output()),
        Command::Verify(arguments) => verify::robot(arguments, output),
        Command::Prove(arguments) => {
            tell("note: `prove` is `verify` now; the old name is there for one release more\n");
            verify::robot(arguments, output)
        }
        Command::Constants(arguments) => constants::write(arguments, output),
        Command::Tune(arguments) => tune::robot(arguments, output),
        Command::Teleop(arguments) => teleop::drive_by_keys(arguments),
        Command::Monitor(arguments) => monitor::listen(arguments),
        Command::Identify(arguments) => identify::run(arguments, output),
        Command::List { directory } => list::list(directory.as_deref()),
        Command::Show { name } => list::show(name),
    }
}

fn simulate(scenario: &Scenario) -> Result<Finished, CommandError> {
    let trace = sim_host::run::run(scenario)?;
    Finished::scenario(scenario, trace).ok_or(CommandError::NoRows)
}

fn drive_alone(mission: &Mission) -> Result<Finished, CommandError> {
    let trace = sim_host::run::drive(mission)?;
    Finished::mission(mission, trace).ok_or(CommandError::NoRows)
}

/// Prints to standard output. A reader that has seen enough (`| head`) does not keep the results
/// from being written.
fn say(text: &str) -> Result<(), CommandError> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CommandError::Print(error)),
        _ => Ok(()),
    }
}

/// Prints to standard error, where it does not disturb a table in a pipe. What comes from files and their names tells a terminal nothing.
pub fn tell(text: &str) {
    // Nobody to read it is no reason to stop.
    let _ = std::io::stderr().write_all(written_out(text).as_bytes());
}

/// Tells what a user should know before the robot finds out.
fn advise(advice: &[Advice]) {
    for sentence in advice {
        tell(&format!("{sentence}\n"));
    }
}

/// As [`advise`], of what is about to be driven. The base of a trajectory `file` had its part where it was loaded.
fn advise_of(mission: &Mission, file: Option<&Trajectory>) {
    if file.is_none() {
        advise(&of_base(&mission.base));
    }
    advise(&of_mission(mission));
}
