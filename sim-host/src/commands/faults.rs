//! `faults`.

use super::error::CommandError;
use super::write::Writer;
use super::{part, say};
use crate::cli::Output;
use crate::part_args::PartArgs;
use sim_host::campaign::{
    Bases, Campaign, Mutation, Plan, Record, RunOutcome, TraceWriter, cells, known, run, table,
    violation, write_runs,
};

/// The files' name.
const NAME: &str = "faults";
/// So many violations are printed; all are in the file.
const PRINTED: usize = 20;

pub fn all(
    campaign: &Campaign,
    run: Option<u64>,
    how: &PartArgs,
    output: &Output,
) -> Result<(), CommandError> {
    if let Some(number) = run {
        if how.shard.is_some() {
            return Err(CommandError::NotInParts("--run"));
        }
        trace(
            &campaign.numbers()?.0,
            campaign.seed,
            number,
            &Writer::new(output)?,
        )?;
    }
    part::run(campaign, how, output, |outcomes| {
        report(campaign, &outcomes, output)
    })
}

/// Prints and writes what a campaign says.
pub fn report(
    campaign: &Campaign,
    outcomes: &[RunOutcome],
    output: &Output,
) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let seed = campaign.seed;
    let cells = cells(outcomes, None);
    say(&format!("seed {seed}\n"))?;
    say(&format!("{}\n", table(&cells)))?;
    say(
        "found within, meanwhile: the latest finding, and the longest way until then. \
         stop / bound: largest share of the stated stopping distance that was used.\n\
         parked off: farthest from the goal that a base truly was that said it was parked.\n\n",
    )?;
    let mut worse = 0;
    for (known, rate) in known(outcomes) {
        let holds = known.holds(&rate);
        worse += usize::from(!holds);
        say(&format!(
            "known: {}, {}: {rate}; stated: {:.2} %{}\n",
            known.injection.name(),
            known.failing.name(),
            1.0e2 * known.rate,
            if holds { "" } else { ": worse" }
        ))?;
    }
    let violations: Vec<_> = outcomes.iter().filter_map(violation).collect();
    for text in violations.iter().take(PRINTED) {
        say(&format!("{text}\n"))?;
    }
    if let Some(first) = outcomes.iter().find(|outcome| outcome.end.is_err()) {
        let run = first.run;
        say(&format!(
            "again, with a trace: sim-host faults --runs 1 --seed {seed} --run {run}{}\n\n",
            if campaign.gyro { " --gyro" } else { "" }
        ))?;
    }
    writer.rows(NAME, |out| write_runs(outcomes, out))?;
    writer.json(NAME, &[Record::of(seed, outcomes, &cells)])?;
    say(&format!(
        "{} of {} runs against the rules; results are in {}\n",
        violations.len(),
        outcomes.len(),
        output.out.display()
    ))?;
    match violations.len() + worse {
        0 => Ok(()),
        count => Err(CommandError::Violations(count)),
    }
}

/// Writes every tick of a run.
fn trace(bases: &Bases, seed: u64, number: u64, writer: &Writer<'_>) -> Result<(), CommandError> {
    let name = format!("{NAME}-{number}.csv");
    let failed = |error: csv::Error| CommandError::Write {
        path: (&name).into(),
        cause: error.to_string(),
    };
    let mut bytes = Vec::new();
    let mut rows = TraceWriter::new(&mut bytes).map_err(failed)?;
    let mut written = Ok(());
    let plan = Plan::draw(bases, seed, number);
    run(bases, &plan, &Mutation::None, |tick| {
        if written.is_ok() {
            written = rows.row(tick);
        }
    })?;
    written.and_then(|()| rows.finish()).map_err(failed)?;
    writer.bytes(&name, &bytes)
}
