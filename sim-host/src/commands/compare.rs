//! `paper` and `compare`.

use super::error::CommandError;
use super::run::law;
use super::write::{Record, Writer};
use super::{Finished, say, simulate, warn};
use crate::cli::Output;
use sim_host::figure::Labelled;
use sim_host::scenario::{BuiltIn, ControlLaw, Scenario};
use sim_host::table::{Column, side_by_side};

/// Built-in scenarios, neural beside plain, with traces.
pub fn paper(names: &[&str], output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    for name in names {
        let missing = || CommandError::NoSuchName((*name).to_owned());
        let scenario = BuiltIn::find(name).ok_or_else(missing)?.scenario()?;
        both_laws(&scenario, true, &writer)?;
    }
    say(&format!(
        "figures, traces and metrics are in {}\n",
        output.out.display()
    ))
}

pub fn scenarios(scenarios: &[Scenario], csv: bool, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    match scenarios {
        [one] => both_laws(one, csv, &writer)?,
        several => beside_each_other(several, csv, &writer)?,
    }
    say(&format!("results are in {}\n", output.out.display()))
}

fn both_laws(scenario: &Scenario, csv: bool, writer: &Writer<'_>) -> Result<(), CommandError> {
    let neural = scenario.with_law(ControlLaw::Neural);
    warn(&neural);
    let runs = [
        simulate(&neural)?,
        simulate(&scenario.with_law(ControlLaw::Plain))?,
    ];
    let name = &scenario.name;
    say(&format!("{name}: {}\n", scenario.description))?;
    print_table(&runs, |run| law(&run.scenario).to_owned())?;
    let title = format!("{name}: {}", scenario.description);
    let [neural, plain] = runs.each_ref().map(|run| Labelled {
        label: law(&run.scenario),
        trace: &run.trace,
    });
    writer.figure(name, &title, neural, Some(plain))?;
    writer.metrics(name, &runs.each_ref().map(Record::from))?;
    if csv {
        for run in &runs {
            writer.csv(&format!("{name}-{}", law(&run.scenario)), &run.trace)?;
        }
    }
    Ok(())
}

fn beside_each_other(
    scenarios: &[Scenario],
    csv: bool,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    scenarios.iter().for_each(warn);
    let runs: Vec<Finished> = scenarios.iter().map(simulate).collect::<Result<_, _>>()?;
    print_table(&runs, |run| run.scenario.name.clone())?;
    let names: Vec<&str> = scenarios.iter().map(|s| s.name.as_str()).collect();
    let records: Vec<Record<'_>> = runs.iter().map(Record::from).collect();
    writer.metrics(&names.join("-vs-"), &records)?;
    let Some((first, others)) = runs.split_first() else {
        return Ok(());
    };
    for other in others {
        let (a, b) = (&first.scenario.name, &other.scenario.name);
        let main = Labelled {
            label: a,
            trace: &first.trace,
        };
        let below = Labelled {
            label: b,
            trace: &other.trace,
        };
        writer.figure(
            &format!("{a}-vs-{b}"),
            &format!("{a} and {b}"),
            main,
            Some(below),
        )?;
    }
    if csv {
        for run in &runs {
            writer.csv(&run.scenario.name, &run.trace)?;
        }
    }
    Ok(())
}

fn print_table(runs: &[Finished], label: impl Fn(&Finished) -> String) -> Result<(), CommandError> {
    let labels: Vec<String> = runs.iter().map(label).collect();
    let columns: Vec<Column<'_>> = labels
        .iter()
        .zip(runs)
        .map(|(label, run)| Column {
            label,
            metrics: &run.metrics,
        })
        .collect();
    say(&format!("{}\n", side_by_side(&columns)))
}
