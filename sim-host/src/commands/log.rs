//! `--log`: what a command's runs leave for other people's tools.

use super::error::CommandError;
use super::write::named;
use crate::log_args::LogArgs;
use sim_host::csv_out::Columns;
use sim_host::datalog::{DataLogError, Pending, logged};
use sim_host::run::Watch;

/// A run that has a log, if one is asked for.
pub fn watched<T, E>(
    log: &LogArgs,
    columns: Columns,
    robot: &str,
    run: impl FnOnce(Watch<'_>) -> Result<T, E>,
) -> Result<T, CommandError>
where
    CommandError: From<E>,
{
    let (done, log) = started(log, columns, robot, run)?;
    finish(log)?;
    Ok(done)
}

/// As [`watched`]; the log is still being written when the run is over, and to be finished. What came before a failure is in it
/// all the same.
pub fn started<T, E>(
    log: &LogArgs,
    columns: Columns,
    robot: &str,
    run: impl FnOnce(Watch<'_>) -> Result<T, E>,
) -> Result<(T, Option<Pending>), CommandError>
where
    CommandError: From<E>,
{
    // The log's own argument names it once.
    if let Some(path) = &log.log
        && named(path) > 1
    {
        return Err(CommandError::OverInput(path.clone()));
    }
    let Some(log) = log.begin(columns.into(), robot, 0.0)? else {
        return Ok((run(None)?, None));
    };
    let (done, log) = logged(log, columns, run);
    match done {
        Ok(done) => Ok((done, Some(log))),
        Err(error) => {
            // The run's error is the one to tell.
            let _ = log.finish();
            Err(error.into())
        }
    }
}

/// Waits for it.
pub fn finish(log: Option<Pending>) -> Result<(), DataLogError> {
    log.map_or(Ok(()), Pending::finish)
}
