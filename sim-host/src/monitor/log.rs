//! Reports as CSV.

use super::Heard;
use firmware_demo::protocol::{Report, report_flags};
use std::io::Write;

/// The columns, in order; names as in the files of `run`. `time_s` is the host's, since the start.
pub const COLUMNS: [&str; 31] = [
    "time_s",
    "tick",
    "state",
    "cause",
    "phase",
    "saturated",
    "handed_over",
    "relaxing",
    "instructions",
    "e_x",
    "e_y",
    "e_theta",
    "s1",
    "s2",
    "s3",
    "vdot_s",
    "wdot_s",
    "v_c",
    "w_c",
    "vdot_c",
    "wdot_c",
    "e_v",
    "e_w",
    "b_v",
    "b_w",
    "tau1",
    "tau2",
    "tau_right",
    "tau_left",
    "step_force",
    "step_moment",
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
    pub fn add(&mut self, time_s: f64, report: &Report, heard: &Heard) -> csv::Result<()> {
        let flag = |bit| if report.flags & bit == 0 { "0" } else { "1" };
        let (state, cause) = match &heard.state {
            Some((state, cause)) => (format!("{state:?}"), format!("{cause:?}")),
            None => Default::default(),
        };
        let phase = match report.phase {
            0 => "tracking",
            _ => "parking",
        };
        let tick = report.tick.to_string();
        let time = format!("{time_s:.6}");
        for text in [&time, &tick, &state, &cause] {
            self.writer.write_field(text)?;
        }
        self.writer.write_field(phase)?;
        for bit in [
            report_flags::SATURATED,
            report_flags::HANDED_OVER,
            report_flags::RELAXING,
        ] {
            self.writer.write_field(flag(bit))?;
        }
        self.writer.write_field(report.instructions.to_string())?;
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

fn numbers(report: &Report) -> [f32; 22] {
    [
        report.e_x,
        report.e_y,
        report.e_theta,
        report.s1,
        report.s2,
        report.s3,
        report.vdot_s,
        report.wdot_s,
        report.v_c,
        report.w_c,
        report.vdot_c,
        report.wdot_c,
        report.e_v,
        report.e_w,
        report.bridge_v,
        report.bridge_w,
        report.force,
        report.moment,
        report.tau_right,
        report.tau_left,
        report.step_force,
        report.step_moment,
    ]
}
