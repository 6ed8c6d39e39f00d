//! A verification as CSV: a row per run.

use super::shortcoming;
use super::study::Run;
use crate::csv_out::{Column, columns, write_file};
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
        "time" => number(run.figures.time_s),
        "error_position" => number(run.figures.error_m),
        "error_heading" => number(run.figures.error_rad),
        "tracking_rms" => run.figures.tracking_m.map(number),
        "ripple" => run.figures.ripple.map(number),
        "effort" => number(run.figures.effort),
        "peak" => run.figures.peak.map(|peak| peak.name),
        "peak_share" => run.figures.peak.map(|peak| number(peak.share)),
        "stopped" => run.figures.stopped.as_ref().map(|stop| &stop.cause),
        "stopped_at" => run.figures.stopped.as_ref().map(|stop| number(stop.time_s)),
        "found" => run.figures.found.join(" "),
    ]
}

fn number(value: f64) -> String {
    format!("{value:e}")
}

/// Writes the runs.
///
/// # Errors
/// Those of the writer.
pub fn write(runs: &[Run], out: impl Write) -> csv::Result<()> {
    write_file(&columns(), runs, out)
}
