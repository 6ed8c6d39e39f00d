//! The campaign for people and for spreadsheets.

use super::outcome::RunOutcome;
use super::run::Tick;
use super::summary::{Cell, CellRecord};
use crate::csv_out::write_numbers;
use crate::scenario::BASES;
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{CellAlignment, Table};
use controller_core::types::Measured;
use serde::Serialize;
use std::io::Write;

const HEADER: [&str; 11] = [
    "trouble",
    "in state",
    "runs",
    "parked",
    "held",
    "stopped by",
    "found\nwithin [s]",
    "meanwhile\n[m]",
    "stop /\nbound",
    "parked off\n[mm, mrad]",
    "against\nthe rules",
];

/// A row for each trouble and state.
pub fn table(cells: &[Cell]) -> Table {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED).set_header(HEADER);
    let mut last = None;
    for cell in cells {
        let name = if last == Some(cell.injection) {
            ""
        } else {
            cell.injection.name()
        };
        last = Some(cell.injection);
        let found = |value: f64| match cell.found {
            0 => String::new(),
            _ => format!("{value:.2}"),
        };
        table.add_row([
            name.to_owned(),
            cell.target.name().to_owned(),
            cell.runs.to_string(),
            cell.parked.to_string(),
            cell.held.to_string(),
            cell.reasons(),
            found(cell.found_s),
            found(cell.blind_m),
            format!("{:.2}", cell.stop.share()),
            off(cell.parked_off),
            cell.violations.to_string(),
        ]);
    }
    for column in [2, 3, 4, 6, 7, 8, 9, 10] {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn off((m, rad): (f64, f64)) -> String {
    if m == 0.0 {
        return String::new();
    }
    format!("{:.1}, {:.1}", 1.0e3 * m, 1.0e3 * rad)
}

/// What one has to know to run a violation again.
pub fn violation(outcome: &RunOutcome) -> Option<String> {
    let violation = outcome.end.as_ref().err()?;
    let second = outcome
        .second
        .map_or_else(String::new, |second| format!(", then {}", second.name()));
    Some(format!(
        "run {}: {}, {} in {} at {:.2} s{second}: at {:.2} s {}",
        outcome.run,
        BASES[outcome.base].name,
        outcome.injection.name(),
        outcome.target.name(),
        outcome.at_s,
        violation.at_s,
        violation.what
    ))
}

/// The columns of [`write_runs`]. SI units; empty where there is nothing.
pub const COLUMNS: [&str; 18] = [
    "run",
    "base",
    "state",
    "trouble",
    "second",
    "at_s",
    "end",
    "by",
    "found_as",
    "found_after_s",
    "found_after_m",
    "stop_m",
    "bound_m",
    "fastest_m_s",
    "counted_s",
    "parked_off_m",
    "parked_off_rad",
    "violation",
];

/// A row for each run.
///
/// # Errors
/// Those of the writer.
pub fn write_runs(outcomes: &[RunOutcome], out: impl Write) -> csv::Result<()> {
    use super::outcome::End;
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for outcome in outcomes {
        let (end, by) = match &outcome.end {
            Ok(End::Held) => ("held", ""),
            Ok(End::Parked) => ("parked", ""),
            Ok(End::Stopped(why)) => ("stopped", why.name()),
            Ok(End::Known(failing)) => ("known", failing.name()),
            Err(_) => ("violation", ""),
        };
        for text in [
            outcome.run.to_string().as_str(),
            BASES[outcome.base].name,
            outcome.target.name(),
            outcome.injection.name(),
            outcome.second.map_or("", |second| second.name()),
            outcome.at_s.to_string().as_str(),
            end,
            by,
            outcome.found.map_or("", |found| found.why.name()),
        ] {
            writer.write_field(text)?;
        }
        for number in [
            outcome.found.map(|found| found.after_s),
            outcome.found.map(|found| found.way_m),
            Some(outcome.stop.way_m),
            Some(outcome.stop.bound_m),
            Some(outcome.fastest),
            Some(outcome.counted_s),
            outcome.parked.map(|(m, _)| m),
            outcome.parked.map(|(_, rad)| rad),
        ] {
            writer.write_field(number.map_or_else(String::new, |n| n.to_string()))?;
        }
        writer.write_field(outcome.end.as_ref().err().map_or("", |v| v.what.as_str()))?;
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    Ok(())
}

/// The campaign as it stands in a file.
#[derive(Debug, Serialize)]
pub struct Record {
    seed: u64,
    runs: usize,
    violations: Vec<String>,
    cells: Vec<CellRecord>,
}

impl Record {
    /// Of all runs.
    pub fn of(seed: u64, outcomes: &[RunOutcome], cells: &[Cell]) -> Self {
        Self {
            seed,
            runs: outcomes.len(),
            violations: outcomes.iter().filter_map(violation).collect(),
            cells: cells.iter().map(CellRecord::from).collect(),
        }
    }
}

/// The trace of one run as CSV, a row for each tick.
pub struct TraceWriter<W: Write>(csv::Writer<W>);

/// The columns of [`TraceWriter`]. SI units, radians; true pose and twist, then the base's.
pub const TRACE_COLUMNS: [&str; 19] = [
    "t",
    "state",
    "cause",
    "active_faults",
    "action",
    "trouble",
    "x",
    "y",
    "theta",
    "v",
    "w",
    "x_base",
    "y_base",
    "v_base",
    "w_base",
    "torque_right",
    "torque_left",
    "stop_m",
    "bound_m",
];

impl<W: Write> TraceWriter<W> {
    /// With the header written.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new(out: W) -> csv::Result<Self> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(TRACE_COLUMNS)?;
        Ok(Self(writer))
    }

    /// A tick.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn row(&mut self, tick: &Tick<'_, '_>) -> csv::Result<()> {
        use controller_core::base::WheelAction;
        let report = tick.board.report();
        let Measured { pose, twist } = tick.board.world().truth();
        let measured = report.measured.unwrap_or_default();
        let active_faults: Vec<_> = report.active_faults.iter().map(|f| f.to_string()).collect();
        let action = match &report.action {
            WheelAction::Release => "release",
            WheelAction::Brake => "brake",
            WheelAction::Drive(_) => "drive",
        };
        let torques = report.action.torques().unwrap_or_default();
        let writer = &mut self.0;
        for text in [
            tick.t.to_string(),
            format!("{:?}", report.state),
            format!("{:?}", report.cause),
            active_faults.join("; "),
            action.to_owned(),
            u8::from(tick.injection).to_string(),
        ] {
            writer.write_field(text)?;
        }
        let f = f64::from;
        let truth = [pose.x, pose.y, pose.theta, twist.linear, twist.angular];
        let base = [
            f(measured.pose.x),
            f(measured.pose.y),
            f(measured.twist.linear),
            f(measured.twist.angular),
            f(torques.right),
            f(torques.left),
            tick.stop.way_m,
            tick.stop.bound_m,
        ];
        write_numbers(writer, truth.into_iter().chain(base))?;
        writer.write_record(None::<&[u8]>)
    }

    /// Everything is written.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(mut self) -> csv::Result<()> {
        self.0.flush()?;
        Ok(())
    }
}
