//! `identify`.

use super::error::CommandError;
use super::say;
use super::write::Writer;
use crate::cli::{IdentifyArgs, Output};
use sim_host::identify::profile::{self, Updated};
use sim_host::identify::{Identified, Known, Log, Options, identify, report};
use sim_host::mission::BaseSpec;
use std::fs::{self, File};
use std::io::{BufReader, ErrorKind};
use std::path::Path;

pub fn log(arguments: &IdentifyArgs, output: &Output) -> Result<(), CommandError> {
    let path = &arguments.log;
    let mut known = Known::default();
    for text in &arguments.known {
        known.state(text)?;
    }
    let file = File::open(path).map_err(|cause| read(path, cause))?;
    let log = Log::read(BufReader::new(file), arguments.counts_per_turn).map_err(|cause| {
        CommandError::Log {
            path: path.clone(),
            cause,
        }
    })?;
    let options = Options {
        known,
        latency_s: arguments.latency,
        slow_rad_s: arguments.slow,
    };
    let found = identify(&log, &options).map_err(|cause| CommandError::Contradiction {
        path: path.clone(),
        cause,
    })?;
    say(&report::text(&found))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Writer::new(output)?.json(&format!("{name}-identify"), &[&found])?;
    match &arguments.profile {
        Some(path) => update(path, &found, options.known.gear),
        None => Ok(()),
    }
}

/// Updates a base's file, or begins one; prints what stands there now and what is odd about it.
fn update(path: &Path, found: &Identified, gear: Option<f64>) -> Result<(), CommandError> {
    let before = match fs::read_to_string(path) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => String::new(),
        text => text.map_err(|cause| read(path, cause))?,
    };
    let written = |cause: String| CommandError::Write {
        path: path.to_owned(),
        cause,
    };
    let Updated { text, notes } =
        profile::update(&before, found, gear).map_err(|error| written(error.to_string()))?;
    fs::write(path, &text).map_err(|error| written(error.to_string()))?;
    say(&text)?;
    for note in notes {
        say(&format!("note: {note}\n"))?;
    }
    // The numbers are the robot's all the same; what contradicts them is for its owner to change.
    match BaseSpec::load(path) {
        Ok(_) => Ok(()),
        Err(error) => say(&format!("note: this is not a whole base yet: {error}\n")),
    }
}

fn read(path: &Path, cause: std::io::Error) -> CommandError {
    CommandError::Read {
        path: path.to_owned(),
        cause,
    }
}
