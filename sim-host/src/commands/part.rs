//! Studies, whole or in parts, and `merge`.

use super::error::CommandError;
use super::{faults, robustness, say, tune, verify};
use crate::cli::Output;
use crate::part_args::{MergeArgs, PartArgs};
use crate::seed_args::SeedArgs;
use indicatif::{ProgressBar, ProgressStyle};
use sim_host::campaign::Campaign;
use sim_host::part::{Parts, Shard, Study, write};
use sim_host::robustness::Robustness;
use sim_host::tune::TuneStudy;
use sim_host::verify::VerifyStudy;
use std::fs;
use std::path::Path;

/// Runs a study and reports on it, or runs a part of it into a file.
pub fn run<S: Study<Error: Into<CommandError>>>(
    study: &S,
    how: &PartArgs,
    output: &Output,
    report: impl FnOnce(Vec<S::Run>) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    let shard = how.shard.unwrap_or(Shard::WHOLE);
    let count = study.count().map_err(Into::into)?;
    let places = shard.places(count);
    // Hidden by itself where standard error is no terminal.
    let bar = ProgressBar::new(study.ticks(&places)).with_style(style());
    let runs = study.runs(places, &|| bar.inc(1));
    bar.finish_and_clear();
    let runs = runs.map_err(Into::into)?;
    let Some(shard) = how.shard else {
        keep(study, Shard::WHOLE, &runs, how.parquet.as_deref())?;
        return report(runs);
    };
    let (number, of) = (shard.number(), shard.count());
    let name = format!("{}-part-{number}-of-{of}.parquet", study.name());
    let path = how.parquet.clone().unwrap_or_else(|| output.out.join(name));
    keep(study, shard, &runs, Some(&path))?;
    say(&format!(
        "part {number} of {of}: {} of {count} runs are in {}\n",
        runs.len(),
        path.display()
    ))
}

/// The seed to use. A fresh one would be another for each part.
pub fn seed(seed: &SeedArgs, how: &PartArgs) -> Result<u64, CommandError> {
    match how.shard {
        Some(_) if seed.fresh => Err(CommandError::NotInParts("--fresh")),
        _ => Ok(seed.draw()?),
    }
}

/// Puts parts together and reports as the command that they are parts of.
pub fn merge(arguments: &MergeArgs, output: &Output) -> Result<(), CommandError> {
    let parts = Parts::read(&arguments.parts)?;
    let whole = arguments.parquet.as_deref();
    let command = parts.command().to_owned();
    if arguments.write.is_some() && command != TuneStudy::COMMAND {
        return Err(CommandError::WriteWhat(command));
    }
    match command.as_str() {
        Campaign::COMMAND => {
            let (study, runs) = together::<Campaign>(parts, whole)?;
            faults::report(&study, &runs, output)
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
            verify::report(&study, runs, output)
        }
        _ => Err(CommandError::NoParts(command)),
    }
}

fn together<S: Study>(parts: Parts, path: Option<&Path>) -> Result<(S, Vec<S::Run>), CommandError> {
    let (study, runs) = parts.merge::<S>()?;
    keep(&study, Shard::WHOLE, &runs, path)?;
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

/// Writes a part's file, if there is to be one.
fn keep<S: Study>(
    study: &S,
    shard: Shard,
    runs: &[S::Run],
    path: Option<&Path>,
) -> Result<(), CommandError> {
    let Some(path) = path else { return Ok(()) };
    let failed = |cause: &dyn std::error::Error| CommandError::Write {
        path: path.to_owned(),
        cause: cause.to_string(),
    };
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory).map_err(|error| failed(&error))?;
    }
    write(path, study, shard, runs).map_err(|error| failed(&error))
}

/// Of progress bars.
pub fn style() -> ProgressStyle {
    let template = "{wide_bar} {pos} of {len} runs, {eta} to go";
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
