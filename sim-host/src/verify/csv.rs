//! A verification as CSV: a row per run.

use super::shortcoming;
use super::study::Run;
use crate::csv_out::{Column, Scientific, Sheet, columns, sheet, write_file};
use std::io::Write;

/// SI units, radians; shares of the limit. Empty: not measured.
///
/// * failed: the first criterion that was not fulfilled; stopped, stopped_at: what for and when.
/// * found: faults, ignored or not, with spaces between them.
fn columns<'a>() -> [Column<&'a Run>; 16] {
    columns![run;
        "course" => run.course.name(),
        "condition" => run.condition.name(),
        "seed" => run.seed,
        "failed" => shortcoming(&run.figures),
        "parked" => run.figures.parked,
        "time" => Scientific(run.figures.time_s),
        "error_position" => Scientific(run.figures.error_m),
        "error_heading" => Scientific(run.figures.error_rad),
        "tracking_rms" => run.figures.tracking_m.map(Scientific),
        "ripple" => run.figures.ripple.map(Scientific),
        "effort" => Scientific(run.figures.effort),
        "peak" => run.figures.peak.map(|peak| peak.name),
        "peak_share" => run.figures.peak.map(|peak| Scientific(peak.share)),
        "stopped" => run.figures.stopped.as_ref().map(|stop| &stop.cause),
        "stopped_at" => run.figures.stopped.as_ref().map(|stop| Scientific(stop.time_s)),
        "found" => run.figures.found.join(" "),
    ]
}

/// Writes the runs.
///
/// # Errors
/// Those of the writer.
pub fn write(runs: &[Run], out: impl Write) -> csv::Result<()> {
    write_file(&columns(), runs, out)
}

/// The runs, column by column.
pub fn run_sheet(runs: &[Run]) -> Sheet {
    sheet(&columns(), runs)
}
