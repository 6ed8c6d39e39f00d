//! `robustness`.

use super::error::CommandError;
use super::write::Writer;
use super::{part, say};
use crate::cli::Output;
use crate::part_args::PartArgs;
use sim_host::figure::robustness as figure;
use sim_host::robustness::{Robustness, Run, rows, tables, write_csv};

/// The files' name.
const NAME: &str = "robustness";

pub fn all(study: &Robustness, how: &PartArgs, output: &Output) -> Result<(), CommandError> {
    part::run(study, how, output, |runs| report(study, &runs, output))
}

/// Prints and writes what a study says.
pub fn report(study: &Robustness, runs: &[Run], output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let conditions = study.conditions()?;
    let rows = rows(&conditions, study.seeds, runs);
    let [settling, ends, noise, peaks] = tables(&rows);
    say(&format!("{settling}\n{ends}\n"))?;
    say(
        "T: settled within 5 cm and 0.05 rad until the hand-over. end: distance to the goal; \
         mean / worst of the seeds.\n\
         expected: of the neural law, by an independent calculation. !: beside the goal.\n\n",
    )?;
    say(&format!("{noise}\n{peaks}\n"))?;
    writer.drawing(NAME, &figure(&rows)?)?;
    writer.rows(NAME, |out| write_csv(&rows, out))?;
    say(&format!("results are in {}\n", output.out.display()))
}
