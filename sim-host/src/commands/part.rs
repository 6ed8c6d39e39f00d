//! Studies, whole or in parts.

use super::error::CommandError;
use super::say;
use crate::cli::Output;
use crate::log_args::LogArgs;
use crate::part_args::PartArgs;
use crate::seed_args::SeedArgs;
use indicatif::{ProgressBar, ProgressStyle};
use sim_host::part::{Shard, Study, write};
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

/// A log is of a run that only the whole study knows.
pub fn without_log(how: &PartArgs, log: &LogArgs) -> Result<(), CommandError> {
    match (&how.shard, &log.log) {
        (Some(_), Some(_)) => Err(CommandError::NotInParts("--log")),
        _ => Ok(()),
    }
}

/// The seed to use. A fresh one would be another for each part.
pub fn seed(seed: &SeedArgs, how: &PartArgs) -> Result<u64, CommandError> {
    match how.shard {
        Some(_) if seed.fresh => Err(CommandError::NotInParts("--fresh")),
        _ => Ok(seed.draw()?),
    }
}

/// Writes a part's file, if there is to be one.
pub fn keep<S: Study>(
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
