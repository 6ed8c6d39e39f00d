//! The campaign for people and for spreadsheets.

use super::outcome::{End, RunOutcome};
use super::run::Tick;
use super::summary::{Cell, CellRecord};
use crate::csv_out::{self, Column, Sheet, columns, fields, names, sheet, write_file, write_row};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{CellAlignment, Table};
use controller_core::base::WheelAction;
use controller_core::types::{Measured, WheelTorques};
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
        outcome.base_name(),
        outcome.injection.name(),
        outcome.target.name(),
        outcome.at_s,
        violation.at_s,
        violation.what
    ))
}

/// SI units; empty where there is nothing.
fn columns<'a>() -> [Column<&'a RunOutcome>; 18] {
    columns![run;
        "run" => run.run,
        "base" => run.base_name(),
        "state" => run.target.name(),
        "trouble" => run.injection.name(),
        "second" => run.second.map(|second| second.name()),
        "at_s" => run.at_s,
        "end" => end(run).0,
        "by" => end(run).1,
        "found_as" => run.found.map(|found| found.why.name()),
        "found_after_s" => run.found.map(|found| found.after_s),
        "found_after_m" => run.found.map(|found| found.way_m),
        "stop_m" => run.stop.way_m,
        "bound_m" => run.stop.bound_m,
        "fastest_m_s" => run.fastest,
        "counted_s" => run.counted_s,
        "parked_off_m" => run.parked.map(|(m, _)| m),
        "parked_off_rad" => run.parked.map(|(_, rad)| rad),
        "violation" => run.end.as_ref().err().map(|violation| &violation.what),
    ]
}

/// How a run ended, and by what.
fn end(run: &RunOutcome) -> (&'static str, &'static str) {
    match &run.end {
        Ok(End::Held) => ("held", ""),
        Ok(End::Parked) => ("parked", ""),
        Ok(End::Stopped(why)) => ("stopped", why.name()),
        Ok(End::Known(failing)) => ("known", failing.name()),
        Err(_) => ("violation", ""),
    }
}

/// A row for each run.
///
/// # Errors
/// Those of the writer.
pub fn write_runs(outcomes: &[RunOutcome], out: impl Write) -> csv::Result<()> {
    write_file(&columns(), outcomes, out)
}

/// The runs, column by column.
pub fn run_sheet(outcomes: &[RunOutcome]) -> Sheet {
    sheet(&columns(), outcomes)
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

/// The fields of a tick, as they stand in the trace of a run, with the names of their columns.
pub fn tick_fields(tick: &Tick<'_, '_>) -> Vec<(&'static str, csv_out::Cell)> {
    fields(&trace_columns(), &tick)
}

/// The trace of one run as CSV, a row for each tick.
pub struct TraceWriter<W: Write>(csv::Writer<W>);

/// SI units, radians; true pose and twist, then the base's.
fn trace_columns<'a, 'b, 'c>() -> [Column<&'a Tick<'b, 'c>>; 19] {
    columns![tick;
        "t" => tick.t,
        "state" => format!("{:?}", tick.board.report().state),
        "cause" => format!("{:?}", tick.board.report().cause),
        "active_faults" => active_faults(tick),
        "action" => match tick.board.report().action {
            WheelAction::Release => "release",
            WheelAction::Brake => "brake",
            WheelAction::Drive(_) => "drive",
        },
        "trouble" => tick.injection,
        "x" => tick.board.world().truth().pose.x,
        "y" => tick.board.world().truth().pose.y,
        "theta" => tick.board.world().truth().pose.theta,
        "v" => tick.board.world().truth().twist.linear,
        "w" => tick.board.world().truth().twist.angular,
        "x_base" => f64::from(measured(tick).pose.x),
        "y_base" => f64::from(measured(tick).pose.y),
        "v_base" => f64::from(measured(tick).twist.linear),
        "w_base" => f64::from(measured(tick).twist.angular),
        "torque_right" => f64::from(torques(tick).right),
        "torque_left" => f64::from(torques(tick).left),
        "stop_m" => tick.stop.way_m,
        "bound_m" => tick.stop.bound_m,
    ]
}

fn active_faults(tick: &Tick<'_, '_>) -> String {
    let faults = tick.board.report().active_faults.iter();
    faults
        .map(|fault| fault.to_string())
        .collect::<Vec<_>>()
        .join("; ")
}

fn measured(tick: &Tick<'_, '_>) -> Measured<f32> {
    tick.board.report().measured.unwrap_or_default()
}

fn torques(tick: &Tick<'_, '_>) -> WheelTorques<f32> {
    tick.board.report().action.torques().unwrap_or_default()
}

impl<W: Write> TraceWriter<W> {
    /// With the header written.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new(out: W) -> csv::Result<Self> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(names(&trace_columns()))?;
        Ok(Self(writer))
    }

    /// A tick.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn row(&mut self, tick: &Tick<'_, '_>) -> csv::Result<()> {
        write_row(&mut self.0, &trace_columns(), &tick)
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
