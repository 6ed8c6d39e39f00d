//! `run`.

use super::error::CommandError;
use super::log::{finish, started};
use super::write::Writer;
use super::{drive, say, warn};
use crate::cli::Output;
use crate::log_args::LogArgs;
use sim_host::csv_out::Columns;
use sim_host::figure::Labelled;
use sim_host::job::Job;
use sim_host::record::{Finished, Record};
use sim_host::run::run_watched;
use sim_host::table::{Column, side_by_side};

pub fn all(jobs: &[Job], csv: bool, log: &LogArgs, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    // One that does not do what it is to do does not keep the others from running.
    let mut not_done = Ok(());
    for job in jobs {
        let log = log.of_run(job.name(), jobs.len());
        let scenario = match job {
            Job::Scenario(scenario) => scenario,
            Job::Mission { mission, file } => {
                match drive::run(mission, file.as_ref(), (csv, &log), &writer) {
                    Err(error @ CommandError::NotDone { .. }) => not_done = Err(error),
                    other => other?,
                }
                continue;
            }
        };
        warn(scenario);
        let (trace, pending) = started(&log, Columns::Paper, &scenario.name, |watch| {
            run_watched(scenario, watch)
        })?;
        let run = Finished::scenario(scenario, trace).ok_or(CommandError::NoRows)?;
        let name = &scenario.name;
        let label = run.controller.law();
        say(&format!("{name}: {}\n", scenario.description))?;
        let metrics = &run.metrics;
        say(&format!("{}\n", side_by_side(&[Column { label, metrics }])))?;
        let trace = &run.trace;
        writer.figure(name, &job.title(), Labelled { label, trace }, None)?;
        writer.json(name, &[Record::from(&run)])?;
        if csv {
            writer.csv(name, trace, Columns::Paper)?;
        }
        finish(pending)?;
    }
    say(&format!("results are in {}\n", output.out.display()))?;
    not_done
}
