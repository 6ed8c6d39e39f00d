//! Reports as CSV.

use super::LatestTelemetry;
use controller_core::safety::FaultKind;
use protocol::{BaseTick, tick_flags};
use std::io::Write;

/// The columns, in order; names as in the files of `run` where the quantity is the same. `time_s` is the host's, since the start;
/// `active_faults` are the faults of the tick, joined by `+`; `ignored_faults` is how many were ignored since power-on.
pub const COLUMNS: [&str; 36] = [
    "time_s",
    "tick",
    "state",
    "cause",
    "law",
    "action",
    "outcome",
    "active_faults",
    "ignored_faults",
    "retries",
    "speed_limited",
    "accel_limited",
    "jerk_limited",
    "torque_limited",
    "disturbance_limited",
    "jumped",
    "backing",
    "blind",
    "fix_used",
    "fix_refused",
    "x",
    "y",
    "theta",
    "v",
    "w",
    "e_x",
    "e_y",
    "e_theta",
    "v_c",
    "w_c",
    "e_v",
    "e_w",
    "load_force",
    "load_moment",
    "tau_right",
    "tau_left",
];

/// A CSV file that grows by a row with each report.
pub struct Log<W: Write> {
    writer: csv::Writer<W>,
}

impl<W: Write> Log<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new(out: W) -> csv::Result<Self> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(COLUMNS)?;
        Ok(Self { writer })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(
        &mut self,
        time_s: f64,
        report: &BaseTick,
        latest: &LatestTelemetry,
    ) -> csv::Result<()> {
        let cause = match &latest.state {
            Some((_, cause)) => format!("{cause:?}"),
            None => String::new(),
        };
        let has = |bit| report.flags & bit != 0;
        let law = match (has(tick_flags::LAW), has(tick_flags::PARKING)) {
            (false, _) => "none",
            (true, false) => "following",
            (true, true) => "parking",
        };
        let kinds = report.codes().filter_map(FaultKind::from_code);
        let active_faults: Vec<&str> = kinds.map(FaultKind::name).collect();
        for text in [
            format!("{time_s:.6}"),
            report.tick.to_string(),
            format!("{:?}", report.state),
            cause,
            law.to_owned(),
            format!("{:?}", report.action),
            format!("{:?}", report.outcome),
            active_faults.join("+"),
            report.ignored.to_string(),
            report.retries.to_string(),
        ] {
            self.writer.write_field(text)?;
        }
        for bit in [
            tick_flags::SPEED_LIMITED,
            tick_flags::ACCEL_LIMITED,
            tick_flags::JERK_LIMITED,
            tick_flags::TORQUE_LIMITED,
            tick_flags::DISTURBANCE_LIMITED,
            tick_flags::JUMPED,
            tick_flags::BACKING,
            tick_flags::BLIND,
            tick_flags::FIX_USED,
            tick_flags::FIX_REFUSED,
        ] {
            self.writer.write_field(if has(bit) { "1" } else { "0" })?;
        }
        for number in numbers(report) {
            // `Display` of a float is the shortest text that reads back as the same float.
            self.writer.write_field(number.to_string())?;
        }
        self.writer.write_record(None::<&[u8]>)
    }

    /// Puts all rows into the file, where they survive the end of the program.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn flush(&mut self) -> csv::Result<()> {
        Ok(self.writer.flush()?)
    }
}

fn numbers(report: &BaseTick) -> [f32; 16] {
    [
        report.x,
        report.y,
        report.theta,
        report.v,
        report.w,
        report.e_x,
        report.e_y,
        report.e_theta,
        report.v_c,
        report.w_c,
        report.e_v,
        report.e_w,
        report.load_force,
        report.load_moment,
        report.tau_right,
        report.tau_left,
    ]
}
