//! `robustness`.

use super::error::CommandError;
use super::say;
use super::write::Writer;
use crate::cli::Output;
use indicatif::{ProgressBar, ProgressStyle};
use sim_host::figure::{png, robustness as figure};
use sim_host::robustness::{Condition, catalogue, runs, study, tables, write_csv};
use std::num::NonZeroU32;

/// The files' name.
const NAME: &str = "robustness";

pub fn all(seeds: NonZeroU32, only: &[String], output: &Output) -> Result<(), CommandError> {
    let conditions = chosen(only)?;
    let writer = Writer::new(output)?;
    // Hidden by itself where standard error is no terminal.
    let bar = ProgressBar::new(runs(&conditions, seeds)).with_style(style());
    let rows = study(&conditions, seeds, || bar.inc(1));
    bar.finish_and_clear();
    let rows = rows?;
    let [settling, ends, noise, peaks] = tables(&rows);
    say(&format!("{settling}\n{ends}\n"))?;
    say(
        "T: settled within 5 cm and 0.05 rad until the hand-over. end: distance to the goal; \
         mean / worst of the seeds.\n\
         expected: of the neural law, by an independent calculation. !: beside the goal.\n\n",
    )?;
    say(&format!("{noise}\n{peaks}\n"))?;
    let svg = figure(&rows)?;
    writer.bytes(&format!("{NAME}.svg"), svg.as_bytes())?;
    writer.bytes(&format!("{NAME}.png"), &png(&svg)?)?;
    writer.rows(NAME, |out| write_csv(&rows, out))?;
    say(&format!("results are in {}\n", output.out.display()))
}

/// The conditions whose names contain one of the words; all without a word.
fn chosen(only: &[String]) -> Result<Vec<Condition>, CommandError> {
    let mut conditions = catalogue();
    if !only.is_empty() {
        if let Some(word) = only
            .iter()
            .find(|word| !conditions.iter().any(|c| c.name.contains(word.as_str())))
        {
            return Err(CommandError::NoCondition {
                word: word.clone(),
                names: conditions.into_iter().map(|c| c.name).collect(),
            });
        }
        conditions.retain(|c| only.iter().any(|word| c.name.contains(word.as_str())));
    }
    Ok(conditions)
}

pub fn style() -> ProgressStyle {
    let template = "{wide_bar} {pos} of {len} runs, {eta} to go";
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
