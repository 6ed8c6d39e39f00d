//! `identify`.

use super::drive::base;
use super::error::CommandError;
use super::identify_live as live;
use super::write::{self, Writer};
use super::{advise, say};
use crate::cli::{IdentifyArgs, Output};
use serde::Serialize;
use sim_host::advice::of_base;
use sim_host::identify::coverage::{self, Rate};
use sim_host::identify::profile::{self, Updated};
use sim_host::identify::{Identified, Known, Log, LogError, Options, Topics, identify, report};
use sim_host::mission::BaseSpec;
use sim_host::ros::read::{Messages, is_bag};
use std::error::Error;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

pub fn run(arguments: &IdentifyArgs, output: &Output) -> Result<(), CommandError> {
    let (log, live) = (&arguments.log, &arguments.live.port);
    match (log.as_ref().or(live.as_ref()), &arguments.coverage) {
        (Some(path), _) => of_one(path, arguments, output),
        (None, Some(base)) => covered(base, arguments, output),
        // The arguments are checked to have one of them.
        (None, None) => Ok(()),
    }
}

/// Coverage as it stands in a JSON file.
#[derive(Serialize)]
struct Record<'a> {
    base: &'a Path,
    runs: usize,
    seed: u64,
    rates: &'a [Rate],
}

fn covered(path: &Path, arguments: &IdentifyArgs, output: &Output) -> Result<(), CommandError> {
    let base = base(Some(path))?;
    let runs = arguments.runs.get();
    let seed = arguments.seed.draw()?;
    say(&format!(
        "{}: {runs} drives, seeds {seed} to {}\n",
        base.name,
        seed.saturating_add(runs as u64 - 1)
    ))?;
    let rates = coverage::coverage(&base, runs, seed)?;
    say(&format!("{}\n", report::coverage(&rates, runs)))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let record = Record {
        base: path,
        runs,
        seed,
        rates: &rates,
    };
    Writer::new(output)?.json(&format!("{name}-coverage"), &[record])?;
    let missed: Vec<_> = rates.iter().filter(|rate| rate.fails()).collect();
    match missed[..] {
        [] => Ok(()),
        _ => Err(CommandError::NotCovered(
            missed.iter().map(|rate| rate.name.clone()).collect(),
        )),
    }
}

/// From a log, or from a drive of the base at this port.
fn of_one(path: &Path, arguments: &IdentifyArgs, output: &Output) -> Result<(), CommandError> {
    let mut known = Known::default();
    for text in &arguments.known {
        known.state(text)?;
    }
    let profile = match &arguments.profile {
        Some(path) => before(path)?,
        None => String::new(),
    };
    known.current_limit_a = known
        .current_limit_a
        .or_else(|| profile::current_limit_a(&profile));
    let counts_per_turn = arguments
        .counts_per_turn
        .or_else(|| profile::counts_per_turn(&profile));
    let failed = |cause| CommandError::Log {
        path: path.to_owned(),
        cause,
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let result = format!("{name}-identify");
    let bytes = if arguments.live.port.is_some() {
        // Before anything moves for nothing.
        counts_per_turn.ok_or_else(|| failed(LogError::CountsPerTurn))?;
        for path in arguments.live.record.iter().chain(&arguments.profile) {
            write::check(path)?;
        }
        Writer::new(output)?.check_json(&result)?;
        live::drive(path, &arguments.live, arguments.seed.draw()? as u32)?
    } else {
        fs::read(path).map_err(|cause| read(path, cause))?
    };
    let log = if is_bag(&bytes) {
        of_bag(path, &bytes, arguments, counts_per_turn)?
    } else {
        Log::read(&bytes, counts_per_turn).map_err(failed)?
    };
    let options = Options {
        known,
        latency_s: arguments.latency,
        slow_rad_s: arguments.slow,
    };
    let found = identify(&log, &options).map_err(|cause| CommandError::Contradiction {
        path: path.to_owned(),
        cause,
    })?;
    say(&report::text(&found))?;
    Writer::new(output)?.json(&result, &[&found])?;
    match &arguments.profile {
        Some(path) => update(path, &found, options.known.gear),
        None => Ok(()),
    }
}

/// By the topics that are named, or the usual ones.
fn of_bag(
    path: &Path,
    bytes: &[u8],
    arguments: &IdentifyArgs,
    counts_per_turn: Option<f64>,
) -> Result<Log, CommandError> {
    let mut topics = Topics::default();
    for text in &arguments.topic {
        topics.state(text).map_err(CommandError::Topic)?;
    }
    topics.joints = arguments.joints.clone();
    let failed = |cause| CommandError::Bag {
        path: path.to_owned(),
        cause,
    };
    let messages = Messages::read(bytes).map_err(failed)?;
    if let Some(why) = &messages.cut {
        say(&format!(
            "note: {} ends early, {why}; what is before is used\n",
            path.display()
        ))?;
    }
    Log::of_bag(&messages, &topics, counts_per_turn).map_err(failed)
}

/// Updates a base's file, or begins one; prints what stands there now and what is odd about it.
fn update(path: &Path, found: &Identified, gear: Option<f64>) -> Result<(), CommandError> {
    let written = |cause: &dyn Error| written(path, cause);
    let Updated { text, notes } =
        profile::update(&before(path)?, found, gear).map_err(|error| written(&error))?;
    fs::write(path, &text).map_err(|error| written(&error))?;
    say(&text)?;
    for note in notes {
        say(&format!("note: {note}\n"))?;
    }
    // The numbers are the robot's all the same; what contradicts them is for its owner to change.
    match BaseSpec::load(path) {
        Ok(base) => {
            advise(&of_base(&base));
            Ok(())
        }
        Err(error) => say(&format!("note: this is not a whole base yet: {error}\n")),
    }
}

/// A base's file as it is, one that can be updated; one that is not there is begun.
fn before(path: &Path) -> Result<String, CommandError> {
    let text = match fs::read_to_string(path) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => String::new(),
        text => text.map_err(|cause| read(path, cause))?,
    };
    profile::check(&text).map_err(|error| written(path, &error))?;
    Ok(text)
}

fn written(path: &Path, cause: &dyn Error) -> CommandError {
    CommandError::Write {
        path: path.to_owned(),
        cause: cause.to_string(),
    }
}

fn read(path: &Path, cause: std::io::Error) -> CommandError {
    CommandError::Read {
        path: path.to_owned(),
        cause,
    }
}
