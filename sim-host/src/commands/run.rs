//! `run`.

use super::error::CommandError;
use super::write::Writer;
use super::{drive, say, simulate, warn};
use crate::cli::Output;
use sim_host::csv_out::Columns;
use sim_host::figure::Labelled;
use sim_host::job::Job;
use sim_host::record::Record;
use sim_host::table::{Column, side_by_side};

pub fn all(jobs: &[Job], csv: bool, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    // One that does not park does not keep the others from running.
    let mut not_parked = Ok(());
    for job in jobs {
        let scenario = match job {
            Job::Scenario(scenario) => scenario,
            Job::Mission { mission, file } => {
                match drive::run(mission, file.as_ref(), csv, &writer) {
                    Err(error @ CommandError::NotParked(_)) => not_parked = Err(error),
                    other => other?,
                }
                continue;
            }
        };
        warn(scenario);
        let run = simulate(scenario)?;
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
    }
    say(&format!("results are in {}\n", output.out.display()))?;
    not_parked
}
