//! `run`.

use super::error::CommandError;
use super::log::{finish, started};
use super::write::Writer;
use super::{advise, drive, say};
use crate::cli::Output;
use crate::log_args::LogArgs;
use sim_host::advice::of_scenario;
use sim_host::csv_out::Columns;
use sim_host::figure::Labelled;
use sim_host::job::Job;
use sim_host::record::{Finished, Record};
use sim_host::run::run_watched;
use sim_host::scenario::Scenario;
use sim_host::table::{Column, side_by_side};

pub fn all(jobs: &[Job], csv: bool, log: &LogArgs, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    // One that does not do what it is to do does not keep the others from running.
    let mut failed = Vec::new();
    for job in jobs {
        let log = log.of_run(job.name(), jobs.len());
        let done = match job {
            Job::Scenario(scenario) => paper(scenario, &job.title(), (csv, &log), &writer),
            Job::Mission { mission, file } => {
                drive::run(mission, file.as_ref(), (csv, &log), &writer)
            }
        };
        match done {
            Err(error @ (CommandError::NotDone { .. } | CommandError::Run(_))) => {
                failed.push(error);
            }
            other => other?,
        }
    }
    say(&format!("results are in {}\n", output.out.display()))?;
    CommandError::all(failed)
}

/// Runs a scenario of the paper's laws and writes its results.
fn paper(
    scenario: &Scenario,
    title: &str,
    (csv, log): (bool, &LogArgs),
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    advise(&of_scenario(scenario));
    let (trace, pending) = started(log, Columns::Paper, &scenario.name, |watch| {
        run_watched(scenario, watch)
    })?;
    let run = Finished::scenario(scenario, trace).ok_or(CommandError::NoRows)?;
    let name = &scenario.name;
    let label = run.controller.law();
    say(&format!("{name}: {}\n", scenario.description))?;
    let metrics = &run.metrics;
    say(&format!("{}\n", side_by_side(&[Column { label, metrics }])))?;
    let trace = &run.trace;
    writer.figure(name, title, Labelled { label, trace }, None)?;
    writer.json(name, &[Record::from(&run)])?;
    if csv {
        writer.csv(name, trace, Columns::Paper)?;
    }
    Ok(finish(pending)?)
}
