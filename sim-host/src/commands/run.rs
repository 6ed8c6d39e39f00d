//! `run`.

use super::error::CommandError;
use super::write::{Record, Writer};
use super::{say, simulate, warn};
use crate::cli::Output;
use sim_host::figure::Labelled;
use sim_host::scenario::{Law, Scenario};
use sim_host::table::{Column, side_by_side};

pub fn all(scenarios: &[Scenario], csv: bool, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    for scenario in scenarios {
        warn(scenario);
        let run = simulate(scenario)?;
        let name = &scenario.name;
        let label = law(scenario);
        say(&format!("{name}: {}\n", scenario.description))?;
        let metrics = &run.metrics;
        say(&format!("{}\n", side_by_side(&[Column { label, metrics }])))?;
        let trace = &run.trace;
        let title = format!("{name}: {}", scenario.description);
        writer.figure(name, &title, Labelled { label, trace }, None)?;
        writer.metrics(name, &[Record::from(&run)])?;
        if csv {
            writer.csv(name, trace)?;
        }
    }
    say(&format!("results are in {}\n", output.out.display()))
}

/// The law's name in tables and legends.
pub fn law(scenario: &Scenario) -> &'static str {
    match scenario.controller.kind {
        Law::Neural => "neural",
        Law::Plain => "plain",
    }
}
