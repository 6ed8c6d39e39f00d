//! `merge`.

use super::error::CommandError;
use super::{faults, part, robustness, tune, verify};
use crate::cli::Output;
use crate::part_args::MergeArgs;
use sim_host::campaign::Campaign;
use sim_host::part::{Parts, Shard, Study};
use sim_host::robustness::Robustness;
use sim_host::tune::TuneStudy;
use sim_host::verify::VerifyStudy;
use std::fs;
use std::path::Path;

/// Puts parts together and reports as the command that they are parts of.
pub fn merge(arguments: &MergeArgs, output: &Output) -> Result<(), CommandError> {
    let parts = Parts::read(&arguments.parts)?;
    let whole = arguments.parquet.as_deref();
    let command = parts.command().to_owned();
    if arguments.write.is_some() && command != TuneStudy::COMMAND {
        return Err(CommandError::WriteWhat(command));
    }
    let log = &arguments.log;
    let logged = [Campaign::COMMAND, VerifyStudy::COMMAND];
    if log.log.is_some() && !logged.contains(&command.as_str()) {
        return Err(CommandError::LogWhat(command));
    }
    match command.as_str() {
        Campaign::COMMAND => {
            let (study, runs) = together::<Campaign>(parts, whole)?;
            faults::report(&study, &runs, Some(log), output)
        }
        Robustness::COMMAND => {
            let (study, runs) = together::<Robustness>(parts, whole)?;
            robustness::report(&study, &runs, output)
        }
        TuneStudy::COMMAND => {
            let (study, finds) = together::<TuneStudy>(parts, whole)?;
            let write = arguments.write.as_deref();
            if let Some(path) = write {
                same_robot(&study, path)?;
            }
            tune::report(&study, &finds, write, output)
        }
        VerifyStudy::COMMAND => {
            let (study, runs) = together::<VerifyStudy>(parts, whole)?;
            verify::report(&study, runs, log, output)
        }
        _ => Err(CommandError::NoParts(command)),
    }
}

fn together<S: Study>(parts: Parts, path: Option<&Path>) -> Result<(S, Vec<S::Run>), CommandError> {
    let (study, runs) = parts.merge::<S>()?;
    part::keep(&study, Shard::WHOLE, &runs, path)?;
    Ok((study, runs))
}

/// Gains go into the file that they were searched for.
fn same_robot(study: &TuneStudy, path: &Path) -> Result<(), CommandError> {
    let text = fs::read_to_string(path).map_err(|cause| CommandError::Read {
        path: path.to_owned(),
        cause,
    })?;
    match text == study.robot.text {
        true => Ok(()),
        false => Err(CommandError::OtherRobot(path.to_owned())),
    }
}
