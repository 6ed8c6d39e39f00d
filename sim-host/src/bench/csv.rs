//! The benchmark as CSV: a row per run.

use super::Run;
use crate::csv_out::{Column, columns, write_file};
use std::io::Write;

/// SI units, radians; torque_step over the wheel's limit. Empty: not measured.
fn columns<'a>() -> [Column<(&'a [String], &'a Run)>; 20] {
    columns![run;
        "track" => run.1.class.track.name(),
        "plant" => run.1.class.plant.name(),
        "base" => run.0.get(run.1.base),
        "course" => run.1.course,
        "seed" => run.1.seed,
        "law" => run.1.law.kind.name(),
        "gains" => run.1.law.flavour.name(),
        "least_time" => number(run.1.minimum_s),
        "arrived" => run.1.figures.arrived_s.map(number),
        "ratio" => run.1.figures.arrived_s.map(|time| number(time / run.1.minimum_s)),
        "parked" => run.1.figures.parked_s.map(number),
        "error_position" => number(run.1.figures.error_m),
        "error_heading" => number(run.1.figures.error_rad),
        "tracking_rms" => run.1.figures.rms_m.map(number),
        "tracking_peak" => run.1.figures.peak_m.map(number),
        "torque_step" => number(run.1.figures.torque_step),
        "jerk_rms" => number(run.1.figures.jerk),
        "energy" => number(run.1.figures.energy_j),
        "failed" => run.1.figures.failed,
        "stopped" => run.1.figures.stopped,
    ]
}

fn number(value: f64) -> String {
    format!("{value:e}")
}

/// Writes the runs.
///
/// # Errors
/// Those of the writer.
pub fn write(bases: &[String], runs: &[Run], out: impl Write) -> csv::Result<()> {
    write_file(&columns(), runs.iter().map(|run| (bases, run)), out)
}
