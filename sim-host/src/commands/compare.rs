//! `paper` and `compare`.

use super::error::CommandError;
use super::write::Writer;
use super::{advise, advise_of, drive_alone, say, simulate};
use crate::cli::{LawArg, Output};
use sim_host::advice::{of_mission, of_scenario};
use sim_host::csv_out::Columns;
use sim_host::figure::Labelled;
use sim_host::job::Job;
use sim_host::mission::BaseSpec;
use sim_host::record::{Finished, Record};
use sim_host::scenario::{BuiltIn, ControlLaw, Scenario};
use sim_host::table::{Column, side_by_side};

/// Built-in scenarios, neural beside plain, with traces.
pub fn paper(names: &[&str], output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    for name in names {
        let missing = || CommandError::NoSuchName((*name).to_owned());
        let scenario = BuiltIn::find(name).ok_or_else(missing)?.scenario()?;
        one_by_law(&scenario, &BOTH, None, true, &writer)?;
    }
    say(&format!(
        "figures, traces and metrics are in {}\n",
        output.out.display()
    ))
}

/// The paper's laws.
const BOTH: [LawArg; 2] = [LawArg::Neural, LawArg::Plain];

/// Each job under its own law, or under each of `laws`; one scenario under both of the paper's laws if none is given.
/// `base` is what the default law drives in a scenario of the paper's laws, if it was chosen.
pub fn jobs(
    jobs: &[Job],
    laws: &[LawArg],
    base: Option<&BaseSpec>,
    csv: bool,
    output: &Output,
) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    match (jobs, laws) {
        ([Job::Scenario(scenario)], []) => one_by_law(scenario, &BOTH, base, csv, &writer)?,
        ([Job::Scenario(scenario)], laws) => one_by_law(scenario, laws, base, csv, &writer)?,
        (several, laws) => {
            let mut runs = Vec::new();
            for job in several {
                runs.extend(runs_of(job, laws, base)?);
            }
            beside_each_other(&runs, laws.len() > 1, csv, &writer)?;
        }
    }
    say(&format!("results are in {}\n", output.out.display()))
}

/// A job under its own law, or under each of `laws`.
fn runs_of(
    job: &Job,
    laws: &[LawArg],
    base: Option<&BaseSpec>,
) -> Result<Vec<Finished>, CommandError> {
    match job {
        Job::Scenario(scenario) if laws.is_empty() => {
            advise(&of_scenario(scenario));
            Ok(vec![simulate(scenario)?])
        }
        Job::Scenario(scenario) => laws.iter().map(|&law| under(scenario, law, base)).collect(),
        Job::Mission { mission, file } => {
            match laws.iter().find(|&&law| law != LawArg::Motion) {
                // What the paper's laws know of limits, worlds and events is nothing.
                Some(_) => Err(CommandError::OnlyMotion(mission.name.clone())),
                None => {
                    advise_of(mission, file.as_ref());
                    Ok(vec![drive_alone(mission)?])
                }
            }
        }
    }
}

/// A scenario of the paper's laws under any law.
fn under(
    scenario: &Scenario,
    law: LawArg,
    base: Option<&BaseSpec>,
) -> Result<Finished, CommandError> {
    let kind = match law {
        LawArg::Neural => ControlLaw::Neural,
        LawArg::Plain => ControlLaw::Plain,
        LawArg::Motion => {
            let base = base.cloned().unwrap_or_else(|| scenario.believed_base());
            let mission = scenario.mission(base);
            advise(&of_mission(&mission));
            return drive_alone(&mission);
        }
    };
    let scenario = scenario.with_law(kind);
    if law == LawArg::Neural {
        advise(&of_scenario(&scenario));
    }
    simulate(&scenario)
}

fn one_by_law(
    scenario: &Scenario,
    laws: &[LawArg],
    base: Option<&BaseSpec>,
    csv: bool,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let runs: Vec<Finished> = laws
        .iter()
        .map(|&law| under(scenario, law, base))
        .collect::<Result<_, _>>()?;
    let name = &scenario.name;
    say(&format!("{name}: {}\n", scenario.description))?;
    let labels: Vec<String> = runs
        .iter()
        .map(|run| run.controller.law().to_owned())
        .collect();
    print_table(&runs, &labels)?;
    let title = format!("{name}: {}", scenario.description);
    let Some((first, others)) = runs.split_first() else {
        return Ok(());
    };
    let labelled = |run: &'_ Finished| run.controller.law();
    let main = Labelled {
        label: labelled(first),
        trace: &first.trace,
    };
    if others.is_empty() {
        writer.figure(name, &title, main, None)?;
    }
    for other in others {
        let below = Labelled {
            label: labelled(other),
            trace: &other.trace,
        };
        let file = match others {
            [_] => name.clone(),
            _ => format!("{name}-{}-vs-{}", labelled(first), labelled(other)),
        };
        writer.figure(&file, &title, main, Some(below))?;
    }
    let records: Vec<Record<'_>> = runs.iter().map(Record::from).collect();
    writer.json(name, &records)?;
    if csv {
        for run in &runs {
            writer.csv(
                &format!("{name}-{}", labelled(run)),
                &run.trace,
                Columns::Paper,
            )?;
        }
    }
    Ok(())
}

fn beside_each_other(
    runs: &[Finished],
    by_law: bool,
    csv: bool,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let labels: Vec<String> = runs
        .iter()
        .map(|run| match by_law {
            true => format!("{}-{}", run.name, run.controller.law()),
            false => run.name.clone(),
        })
        .collect();
    print_table(runs, &labels)?;
    let records: Vec<Record<'_>> = runs.iter().map(Record::from).collect();
    writer.json(&labels.join("-vs-"), &records)?;
    let mut labelled = labels
        .iter()
        .zip(runs)
        .map(|(label, Finished { trace, .. })| Labelled { label, trace });
    let Some(main) = labelled.next() else {
        return Ok(());
    };
    for below in labelled {
        let (a, b) = (main.label, below.label);
        let file = format!("{a}-vs-{b}");
        writer.figure(&file, &format!("{a} and {b}"), main, Some(below))?;
    }
    if csv {
        for (label, run) in labels.iter().zip(runs) {
            writer.csv(label, &run.trace, Columns::Paper)?;
        }
    }
    Ok(())
}

fn print_table(runs: &[Finished], labels: &[String]) -> Result<(), CommandError> {
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
