//! The study as CSV: a row per condition, case and law, in full precision.

use super::condition::Expected;
use super::law::ComparedLaw;
use super::study::StudyRow;
use crate::csv_out::{Column, columns, names, write_file};
use std::io::Write;

/// SI units, radians. Empty: not settled, not parked, nothing expected.
///
/// * mean and worst are over the seeds; settled and parked only if all runs did.
/// * force_std, moment_std: over the last second of following and of the run; peaks: of all runs,
///   as exerted.
/// * expected: low and high, of the paper's law, in seconds and metres.
fn columns<'a, 'b>() -> [Column<&'a StudyRow<'b>>; 24] {
    columns![row;
        "condition" => row.condition.name,
        "case" => row.case.name(),
        "law" => row.law.name(),
        "verdict" => row.outcome.verdict.name(),
        "runs" => row.outcome.runs,
        "arrived" => row.outcome.arrived,
        "settled_mean" => row.outcome.settling_s.map(|s| s.mean),
        "settled_worst" => row.outcome.settling_s.map(|s| s.worst),
        "parked_mean" => row.outcome.parked_s.map(|s| s.mean),
        "parked_worst" => row.outcome.parked_s.map(|s| s.worst),
        "final_position_mean" => row.outcome.final_m.mean,
        "final_position_worst" => row.outcome.final_m.worst,
        "final_heading_mean" => row.outcome.final_rad.mean,
        "final_heading_worst" => row.outcome.final_rad.worst,
        "following_force_std" => row.outcome.following_std.force,
        "following_moment_std" => row.outcome.following_std.moment,
        "rest_force_std" => row.outcome.rest_std.force,
        "rest_moment_std" => row.outcome.rest_std.moment,
        "peak_force" => row.outcome.peak_force_n,
        "peak_moment" => row.outcome.peak_moment_nm,
        "expected_settled_low" => expected(row).settling_s.map(|(low, _)| low),
        "expected_settled_high" => expected(row).settling_s.map(|(_, high)| high),
        "expected_final_low" => expected(row).final_mm.map(|(low, _)| low * 1.0e-3),
        "expected_final_high" => expected(row).final_mm.map(|(_, high)| high * 1.0e-3),
    ]
}

fn expected(row: &StudyRow<'_>) -> Expected {
    match row.law {
        ComparedLaw::Neural => *row.case.expected(row.condition),
        ComparedLaw::Plain | ComparedLaw::Default => Expected::default(),
    }
}

/// The names of the columns, in order.
pub fn column_names() -> Vec<&'static str> {
    names(&columns())
}

/// Writes the study.
///
/// # Errors
/// Those of the writer.
pub fn write(rows: &[StudyRow<'_>], out: impl Write) -> csv::Result<()> {
    write_file(&columns(), rows, out)
}
