//! A verification as CSV: a row per run.

use super::shortcoming;
use super::study::Run;
use std::io::Write;

/// The columns, in order. SI units, radians; shares of the limit. Empty: not measured.
///
/// * failed: the first criterion that was not fulfilled; stopped, stopped_at: what for and when.
/// * found: faults, ignored or not, with spaces between them.
pub const COLUMNS: [&str; 16] = [
    "course",
    "condition",
    "seed",
    "failed",
    "parked",
    "time",
    "error_position",
    "error_heading",
    "tracking_rms",
    "ripple",
    "effort",
    "peak",
    "peak_share",
    "stopped",
    "stopped_at",
    "found",
];

/// Writes the runs.
///
/// # Errors
/// Those of the writer.
pub fn write(runs: &[Run], out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    let number = |value: f64| format!("{value:e}");
    let maybe = |value: Option<f64>| value.map_or_else(String::new, number);
    for run in runs {
        let f = &run.figures;
        let stop = f.stopped.as_ref();
        writer.write_record([
            run.course.name().to_owned(),
            run.condition.name().to_owned(),
            run.seed.to_string(),
            shortcoming(f).unwrap_or_default().to_owned(),
            u8::from(f.parked).to_string(),
            number(f.time_s),
            number(f.error_m),
            number(f.error_rad),
            maybe(f.tracking_m),
            maybe(f.ripple),
            number(f.effort),
            f.peak.map_or("", |peak| peak.name).to_owned(),
            maybe(f.peak.map(|peak| peak.share)),
            stop.map_or_else(String::new, |stop| stop.cause.clone()),
            maybe(stop.map(|stop| stop.time_s)),
            f.found.join(" "),
        ])?;
    }
    writer.flush()?;
    Ok(())
}
