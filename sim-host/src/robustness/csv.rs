//! The study as CSV: a row per condition, case and law, in full precision.

use super::condition::Range;
use super::law::ComparedLaw;
use super::study::{Spread, StudyRow};
use crate::csv_out::write_numbers;
use std::io::Write;

/// The columns, in order. SI units, radians. Empty: not settled, not parked, nothing expected.
///
/// * mean and worst are over the seeds; settled and parked only if all runs did.
/// * force_std, moment_std: over the last second of following and of the run; peaks: of all runs,
///   as exerted.
/// * expected: low and high, of the paper's law, in seconds and metres.
pub const COLUMNS: [&str; 24] = [
    "condition",
    "case",
    "law",
    "verdict",
    "runs",
    "arrived",
    "settled_mean",
    "settled_worst",
    "parked_mean",
    "parked_worst",
    "final_position_mean",
    "final_position_worst",
    "final_heading_mean",
    "final_heading_worst",
    "following_force_std",
    "following_moment_std",
    "rest_force_std",
    "rest_moment_std",
    "peak_force",
    "peak_moment",
    "expected_settled_low",
    "expected_settled_high",
    "expected_final_low",
    "expected_final_high",
];

/// Writes the study.
///
/// # Errors
/// Those of the writer.
pub fn write(rows: &[StudyRow<'_>], out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for row in rows {
        let outcome = &row.outcome;
        for text in [
            row.condition.name.as_str(),
            row.case.name(),
            row.law.name(),
            outcome.verdict.name(),
        ] {
            writer.write_field(text)?;
        }
        writer.write_field(outcome.runs.to_string())?;
        writer.write_field(outcome.arrived.to_string())?;
        for spread in [outcome.settling_s, outcome.parked_s] {
            pair(&mut writer, spread.map(|s: Spread| (s.mean, s.worst)), 1.0)?;
        }
        for spread in [outcome.final_m, outcome.final_rad] {
            pair(&mut writer, Some((spread.mean, spread.worst)), 1.0)?;
        }
        let (following, rest) = (outcome.following_std, outcome.rest_std);
        let torques = [following.force, following.moment, rest.force, rest.moment];
        let peaks = [outcome.peak_force_n, outcome.peak_moment_nm];
        write_numbers(&mut writer, torques.into_iter().chain(peaks))?;
        let expected = match row.law {
            ComparedLaw::Neural => *row.case.expected(row.condition),
            ComparedLaw::Plain | ComparedLaw::Default => Default::default(),
        };
        pair(&mut writer, expected.settling_s, 1.0)?;
        pair(&mut writer, expected.final_mm, 1.0e-3)?;
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    Ok(())
}

fn pair<W: Write>(writer: &mut csv::Writer<W>, pair: Option<Range>, scale: f64) -> csv::Result<()> {
    match pair {
        Some((low, high)) => write_numbers(writer, [low * scale, high * scale]),
        None => {
            writer.write_field("")?;
            writer.write_field("")
        }
    }
}
