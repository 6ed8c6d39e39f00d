//! `faults`.

use super::error::CommandError;
use super::write::Writer;
use super::{part, say};
use crate::cli::Output;
use crate::log_args::LogArgs;
use crate::part_args::PartArgs;
use sim_host::campaign::{
    Campaign, Mutation, Plan, Record, RunOutcome, Tick, TraceWriter, cells, known, run, table,
    tick_fields, violation, write_runs,
};
use sim_host::datalog::{DataLog, Source};
use sim_host::part::{Study as _, quoted};
use sim_host::verify::likely;

/// So many violations are printed; all are in the file.
const PRINTED: usize = 20;

/// `run` is the one that is looked at tick by tick, and has the log; else the first that broke a rule.
pub fn all(
    campaign: &Campaign,
    (run, log): (Option<u64>, &LogArgs),
    how: &PartArgs,
    output: &Output,
) -> Result<(), CommandError> {
    if let Some(number) = run {
        if how.shard.is_some() {
            return Err(CommandError::NotInParts("--run"));
        }
        trace(campaign, number, log, &Writer::new(output)?)?;
    }
    part::without_log(how, log)?;
    let log = run.is_none().then_some(log);
    part::run(campaign, how, output, |outcomes| {
        report(campaign, &outcomes, log, output)
    })
}

/// Prints and writes what a campaign says.
pub fn report(
    campaign: &Campaign,
    outcomes: &[RunOutcome],
    log: Option<&LogArgs>,
    output: &Output,
) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let seed = campaign.seed;
    let cells = cells(outcomes, None);
    if let Some(robot) = campaign.on.own() {
        say(&format!("{}: {}, ", robot.name, robot.base.name))?;
    }
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
    if let (Some(robot), false) = (campaign.on.own(), violations.is_empty()) {
        say(&likely(&robot.base))?;
    }
    if let Some(first) = outcomes.iter().find(|outcome| outcome.end.is_err()) {
        let run = first.run;
        say(&format!(
            "again, with a trace: sim-host faults --runs 1 --seed {seed} --run {run}{}\n\n",
            on_what(campaign)
        ))?;
    }
    if let Some(asked) = log
        && let Some(path) = &asked.log
    {
        match outcomes.iter().find(|outcome| outcome.end.is_err()) {
            Some(first) => again(campaign, first.run, asked, |_| {})?,
            None => say(&format!(
                "no run broke a rule: {} was not written\n",
                path.display()
            ))?,
        }
    }
    let name = campaign.name();
    writer.rows(&name, |out| write_runs(outcomes, out))?;
    writer.json(&name, &[Record::of(seed, outcomes, &cells)])?;
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

/// The words of a command that say on what bases a campaign runs.
fn on_what(campaign: &Campaign) -> String {
    let words = campaign.on.arguments();
    words
        .iter()
        .map(|word| format!(" {}", quoted(word)))
        .collect()
}

/// Runs it again, with every tick in a CSV file, and with a log if one is asked for.
fn trace(
    campaign: &Campaign,
    number: u64,
    log: &LogArgs,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let name = format!("{}-{number}.csv", campaign.name());
    let failed = |error: csv::Error| CommandError::Write {
        path: (&name).into(),
        cause: error.to_string(),
    };
    let mut bytes = Vec::new();
    let mut rows = TraceWriter::new(&mut bytes).map_err(failed)?;
    let mut written = Ok(());
    again(campaign, number, log, |tick| {
        if written.is_ok() {
            written = rows.row(tick);
        }
    })?;
    written.and_then(|()| rows.finish()).map_err(failed)?;
    writer.bytes(&name, &bytes)
}

/// Runs it again, with a log if one is asked for; `seen` sees every tick.
fn again(
    campaign: &Campaign,
    number: u64,
    asked: &LogArgs,
    mut seen: impl FnMut(&Tick<'_, '_>),
) -> Result<(), CommandError> {
    let (bases, _) = campaign.numbers()?;
    let plan = Plan::draw(&bases, campaign.seed, number);
    let mut log = asked.begin(Source::Campaign, &bases.of(&plan).name, 0.0)?;
    let mut written = Ok(());
    run(&bases, &plan, &Mutation::None, |tick| {
        seen(tick);
        if let (Some(log), Ok(())) = (&mut log, &written) {
            written = log.add(&tick.into(), &tick_fields(tick));
        }
    })?;
    written?;
    Ok(log.map_or(Ok(()), DataLog::finish)?)
}
