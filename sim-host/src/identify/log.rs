//! The log: commands, wheel angles and what else was recorded, from CSV.

use crate::import::table::{broken, line_at, reader, said};
use crate::import::{Format, Place, Reason, Refusal, text};
use csv::StringRecord;
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

/// What acted on the wheels, right before left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Wheel torques \[N m\], as a torque-controlled drive delivers them.
    Torque,
    /// Motor voltages \[V\]: as logged, or duty times the supply of the next row, which is that under this duty.
    Voltage,
    /// Duty, -1 to 1, of a supply that the log does not have.
    Duty,
}

/// A fix of the external pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// The row that it stands in.
    pub row: usize,
    /// x \[m\], y \[m\], theta \[rad\].
    pub pose: [f64; 3],
    /// How long before that row it was valid, as far as the log says so; [`Options::latency_s`](super::Options::latency_s) comes
    /// on top \[s\].
    pub age_s: f64,
}

/// A log, row by row. Pairs are right, left.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// Times \[s\], rising.
    pub t: Vec<f64>,
    /// What `command` is.
    pub drive: Drive,
    /// Commands: each acts from its row's time to the next row's.
    pub command: Vec<[f64; 2]>,
    /// Of duties that a supply was logged with: the voltage of full duty under each row's command \[V\].
    pub supply: Option<Vec<f64>>,
    /// Wheel angles \[rad\] at the row's time.
    pub angle: Vec<[f64; 2]>,
    /// Step of the wheel angles \[rad\], if they come from counts.
    pub step_rad: Option<f64>,
    /// Motor currents \[A\], measured together with the angles: before the row's command acts.
    pub current: Option<Vec<[f64; 2]>>,
    /// External poses, where there are any.
    pub fixes: Vec<Fix>,
}

/// Why a log cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// Not CSV.
    #[error(transparent)]
    Csv(#[from] Refusal),
    /// A column is missing from the header, which is on this line.
    #[error("line {0}: {1}")]
    Columns(usize, String),
    /// A cell is not what it should be.
    #[error("line {line}, column `{column}`: {problem}")]
    Cell {
        /// Counted from 1, header and comments included.
        line: usize,
        /// Name in the header.
        column: String,
        /// What is wrong.
        problem: String,
    },
    /// Counts need a scale.
    #[error("counts need --counts-per-turn (counts of one whole turn of the wheel)")]
    CountsPerTurn,
    /// Fewer than [`MIN_ROWS`].
    #[error("{0} rows are too few: at least {MIN_ROWS} are needed")]
    Short(usize),
}

/// Nothing in a log is larger, neither seconds since 1970 nor counts; squares of much larger numbers overflow, and to decompose
/// a matrix of what comes then takes for ever.
const MAX_CELL: f64 = 1.0e12;

/// Fewer rows cannot hold even one stretch of driving.
pub const MIN_ROWS: usize = 20;

struct Sheet {
    /// The header's.
    line: usize,
    columns: HashMap<String, usize>,
    /// Names that several columns have.
    repeated: HashSet<String>,
    rows: Vec<Row>,
}

struct Row {
    line: usize,
    cells: StringRecord,
}

impl Sheet {
    fn has(&self, names: &[&str]) -> Result<bool, LogError> {
        if let Some(name) = names.iter().find(|name| self.repeated.contains(**name)) {
            return Err(self.wrong(format!("column `{name}` is there twice")));
        }
        let there = |name: &&&str| self.columns.contains_key(**name);
        match names.iter().filter(there).count() {
            0 => Ok(false),
            n if n == names.len() => Ok(true),
            _ => Err(self.wrong(format!(
                "of the columns {} some are missing",
                names.join(", ")
            ))),
        }
    }

    fn wrong(&self, problem: String) -> LogError {
        LogError::Columns(self.line, problem)
    }

    fn cell(&self, row: &Row, column: &str) -> Result<Option<f64>, LogError> {
        let index = self.columns.get(column).copied().unwrap_or(usize::MAX);
        let text = row.cells.get(index).unwrap_or_default();
        let problem = match text.parse::<f64>() {
            _ if text.is_empty() => return Ok(None),
            Ok(value) if value.abs() <= MAX_CELL => return Ok(Some(value)),
            Ok(value) if value.is_finite() => {
                format!("`{text}` is not within ±{MAX_CELL:e}: is it in SI units?")
            }
            Ok(_) => format!("`{text}` is not finite"),
            Err(_) => format!("`{text}` is not a number"),
        };
        Err(wrong(row, column, problem))
    }

    fn number(&self, row: &Row, column: &str) -> Result<f64, LogError> {
        self.cell(row, column)?
            .ok_or_else(|| wrong(row, column, "empty".to_owned()))
    }

    fn pairs(&self, name: &str, scale: f64) -> Result<Vec<[f64; 2]>, LogError> {
        let (right, left) = (format!("{name}_right"), format!("{name}_left"));
        let pair = |row| {
            Ok([
                scale * self.number(row, &right)?,
                scale * self.number(row, &left)?,
            ])
        };
        self.rows.iter().map(pair).collect()
    }

    /// The one of several alternatives that the header has.
    fn only(&self, what: &str, names: &[&'static str]) -> Result<&'static str, LogError> {
        let mut found = Vec::new();
        for name in names {
            if self.has(&[&format!("{name}_right"), &format!("{name}_left")])? {
                found.push(*name);
            }
        }
        match found[..] {
            [name] => Ok(name),
            _ => Err(self.wrong(format!(
                "needs one pair of {what} columns: {}_right and {}_left; found {}",
                names.join("_right/_left, or "),
                names.last().unwrap_or(&""),
                if found.is_empty() { "none" } else { "several" },
            ))),
        }
    }
}

fn wrong(row: &Row, column: &str, problem: String) -> LogError {
    LogError::Cell {
        line: row.line,
        column: column.to_owned(),
        problem,
    }
}

/// By the rules for trajectory files.
fn sheet(text: &str) -> Result<Sheet, Refusal> {
    let text = &*said(text);
    let mut reader = reader(text);
    let header = reader.headers().map_err(|e| broken(text, &e))?.clone();
    let rows = reader.records().map(|cells| {
        let cells = cells.map_err(|e| broken(text, &e))?;
        Ok(Row {
            line: line_at(text, cells.position()),
            cells,
        })
    });
    if header.is_empty() {
        return Err(Refusal::new(Format::Csv, Place::default(), Reason::Empty));
    }
    let mut columns = HashMap::new();
    let names = header.iter().map(str::to_owned).zip(0..);
    let repeated =
        names.filter_map(|(name, place)| columns.insert(name.clone(), place).map(|_| name));
    let repeated = repeated.collect();
    Ok(Sheet {
        line: line_at(text, header.position()),
        columns,
        repeated,
        rows: rows.collect::<Result<_, _>>()?,
    })
}

impl Log {
    /// Reads a log with a header line; other columns than those of `docs/identify.md` are skipped.
    /// `counts_per_turn` is for columns `counts_right`, `counts_left`.
    ///
    /// # Errors
    /// What is wrong, with line and column.
    pub fn read(bytes: &[u8], counts_per_turn: Option<f64>) -> Result<Self, LogError> {
        let sheet = sheet(&text(bytes)?)?;
        if !sheet.has(&["t"])? {
            let why = "column `t` is missing: names are in small letters, with commas and not semicolons or tabs between them";
            return Err(sheet.wrong(why.to_owned()));
        }
        if sheet.rows.len() < MIN_ROWS {
            return Err(LogError::Short(sheet.rows.len()));
        }
        let t = times(&sheet)?;
        let (drive, command, supply) = commands(&sheet)?;
        let (angle, step_rad) = angles(&sheet, counts_per_turn)?;
        let current = match sheet.has(&["current_right", "current_left"])? {
            true => Some(sheet.pairs("current", 1.0)?),
            false => None,
        };
        let fixes = fixes(&sheet)?;
        Ok(Self {
            t,
            drive,
            command,
            supply,
            angle,
            step_rad,
            current,
            fixes,
        })
    }

    /// Whether commands are duties, which a driver's dead band acts on.
    pub(super) fn of_duties(&self) -> bool {
        self.drive == Drive::Duty || self.supply.is_some()
    }
}

/// Duties as voltages, and the supply under each: that of the next row, for what a row measures is under the
/// command of the row before, by which a battery sags.
pub(super) fn voltages(duty: &[[f64; 2]], measured: &[f64]) -> (Vec<[f64; 2]>, Vec<f64>) {
    let under: Vec<_> = measured
        .iter()
        .skip(1)
        .chain(measured.last())
        .copied()
        .collect();
    let volts = duty.iter().zip(&under);
    let volts = volts.map(|(pair, supply)| pair.map(|duty| duty * supply));
    (volts.collect(), under)
}

fn times(sheet: &Sheet) -> Result<Vec<f64>, LogError> {
    let mut times = Vec::with_capacity(sheet.rows.len());
    for row in &sheet.rows {
        let time = sheet.number(row, "t")?;
        if let Some(&before) = times.last()
            && time <= before
        {
            let problem = format!("{time} s is not later than {before} s in the row before");
            return Err(wrong(row, "t", problem));
        }
        times.push(time);
    }
    Ok(times)
}

type Commands = (Drive, Vec<[f64; 2]>, Option<Vec<f64>>);

fn commands(sheet: &Sheet) -> Result<Commands, LogError> {
    let name = sheet.only("command", &["duty", "voltage", "torque"])?;
    let command = sheet.pairs(name, 1.0)?;
    if name != "duty" {
        let drive = if name == "torque" {
            Drive::Torque
        } else {
            Drive::Voltage
        };
        return Ok((drive, command, None));
    }
    for (row, pair) in sheet.rows.iter().zip(&command) {
        for (value, column) in pair.iter().zip(["duty_right", "duty_left"]) {
            if value.abs() > 1.0 {
                return Err(wrong(row, column, format!("{value} is not within -1 to 1")));
            }
        }
    }
    if !sheet.has(&["supply"])? {
        return Ok((Drive::Duty, command, None));
    }
    let supplies: Vec<f64> = sheet
        .rows
        .iter()
        .map(|row| sheet.number(row, "supply"))
        .collect::<Result<_, _>>()?;
    let (command, under) = voltages(&command, &supplies);
    Ok((Drive::Voltage, command, Some(under)))
}

type Angles = (Vec<[f64; 2]>, Option<f64>);

fn angles(sheet: &Sheet, counts_per_turn: Option<f64>) -> Result<Angles, LogError> {
    if sheet.only("encoder", &["counts", "angle"])? == "angle" {
        return Ok((sheet.pairs("angle", 1.0)?, None));
    }
    let step = TAU / counts_per_turn.ok_or(LogError::CountsPerTurn)?;
    Ok((sheet.pairs("counts", step)?, Some(step)))
}

fn fixes(sheet: &Sheet) -> Result<Vec<Fix>, LogError> {
    let names = ["x", "y", "theta"];
    let mut fixes = Vec::new();
    if !sheet.has(&names)? {
        return Ok(fixes);
    }
    let aged = sheet.has(&["age"])?;
    for (index, row) in sheet.rows.iter().enumerate() {
        let cells = [
            sheet.cell(row, "x")?,
            sheet.cell(row, "y")?,
            sheet.cell(row, "theta")?,
        ];
        match cells {
            [Some(x), Some(y), Some(theta)] => fixes.push(Fix {
                row: index,
                pose: [x, y, theta],
                age_s: match aged {
                    true => sheet.number(row, "age")?,
                    false => 0.0,
                },
            }),
            [None, None, None] => {}
            _ => {
                let empty = cells.iter().zip(names).find(|(cell, _)| cell.is_none());
                let column = empty.map_or("x", |(_, name)| name);
                let problem = "empty, but the row has other parts of a pose".to_owned();
                return Err(wrong(row, column, problem));
            }
        }
    }
    Ok(fixes)
}
