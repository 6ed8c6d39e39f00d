//! Reports as CSV.

use super::LatestTelemetry;
use crate::csv_out::{Cell, Column, Fixed, columns, fields, names, write_row};
use controller_core::safety::FaultKind;
use protocol::{BaseTick, tick_flags};
use std::io::Write;

struct Row<'a> {
    time_s: f64,
    tick: &'a BaseTick,
    latest: &'a LatestTelemetry,
}

impl Row<'_> {
    fn has(&self, bit: u16) -> bool {
        self.tick.flags & bit != 0
    }

    fn law(&self) -> &'static str {
        match (self.has(tick_flags::LAW), self.has(tick_flags::PARKING)) {
            (false, _) => "none",
            (true, false) => "following",
            (true, true) => "parking",
        }
    }

    fn active_faults(&self) -> String {
        let kinds = self.tick.codes().filter_map(FaultKind::from_code);
        kinds.map(FaultKind::name).collect::<Vec<_>>().join("+")
    }

    fn cause(&self) -> Option<String> {
        let (_, cause) = self.latest.state.as_ref()?;
        Some(format!("{cause:?}"))
    }
}

/// Names as in the files of `run` where the quantity is the same. `time_s` is the host's, since the start;
/// `active_faults` are the faults of the tick, joined by `+`; `ignored_faults` is how many were ignored since power-on.
fn columns<'a>() -> [Column<Row<'a>>; 39] {
    columns![row;
        "time_s" => Fixed(row.time_s),
        "tick" => row.tick.tick,
        "state" => format!("{:?}", row.tick.state),
        "cause" => row.cause(),
        "law" => row.law(),
        "action" => format!("{:?}", row.tick.action),
        "outcome" => format!("{:?}", row.tick.outcome),
        "active_faults" => row.active_faults(),
        "ignored_faults" => row.tick.ignored,
        "retries" => row.tick.retries,
        "speed_limited" => row.has(tick_flags::SPEED_LIMITED),
        "accel_limited" => row.has(tick_flags::ACCEL_LIMITED),
        "jerk_limited" => row.has(tick_flags::JERK_LIMITED),
        "torque_limited" => row.has(tick_flags::TORQUE_LIMITED),
        "disturbance_limited" => row.has(tick_flags::DISTURBANCE_LIMITED),
        "grip_limited" => row.has(tick_flags::GRIP_LIMITED),
        "jumped" => row.has(tick_flags::JUMPED),
        "backing" => row.has(tick_flags::BACKING),
        "blind" => row.has(tick_flags::BLIND),
        "fix_used" => row.has(tick_flags::FIX_USED),
        "fix_refused" => row.has(tick_flags::FIX_REFUSED),
        "gyro_used" => row.has(tick_flags::GYRO_USED),
        "sliding" => row.has(tick_flags::SLIDING),
        "x" => row.tick.x,
        "y" => row.tick.y,
        "theta" => row.tick.theta,
        "v" => row.tick.v,
        "w" => row.tick.w,
        "e_x" => row.tick.e_x,
        "e_y" => row.tick.e_y,
        "e_theta" => row.tick.e_theta,
        "v_c" => row.tick.v_c,
        "w_c" => row.tick.w_c,
        "e_v" => row.tick.e_v,
        "e_w" => row.tick.e_w,
        "load_force" => row.tick.load_force,
        "load_moment" => row.tick.load_moment,
        "tau_right" => row.tick.tau_right,
        "tau_left" => row.tick.tau_left,
    ]
}

/// The names of the columns, in order.
pub fn column_names() -> Vec<&'static str> {
    names(&columns())
}

/// The fields of a report, as they stand in the file, with the names of their columns.
pub fn report_fields(
    time_s: f64,
    tick: &BaseTick,
    latest: &LatestTelemetry,
) -> Vec<(&'static str, Cell)> {
    let row = Row {
        time_s,
        tick,
        latest,
    };
    fields(&columns(), &row)
}

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
        writer.write_record(column_names())?;
        Ok(Self { writer })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(
        &mut self,
        time_s: f64,
        tick: &BaseTick,
        latest: &LatestTelemetry,
    ) -> csv::Result<()> {
        let row = Row {
            time_s,
            tick,
            latest,
        };
        write_row(&mut self.writer, &columns(), &row)
    }

    /// Puts all rows into the file, where they survive the end of the program.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn flush(&mut self) -> csv::Result<()> {
        Ok(self.writer.flush()?)
    }
}
