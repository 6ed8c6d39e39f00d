//! Plain CSV: commas, `#` comments, and a header that names the columns in any order.
//!
//! | column | meaning | unit | required |
//! | --- | --- | --- | --- |
//! | `t` | time | s | yes |
//! | `x`, `y` | position | m | yes |
//! | `theta` | heading, counter-clockwise from the x axis, wrapped or not | rad | yes |
//! | `v` | speed, negative when backing up | m/s | no |
//! | `w` | turn rate | rad/s | no |
//! | `a`, `alpha` | their rates; must be numbers, the reference has its own | m/s², rad/s² | no |
//!
//! Speeds and turn rates that contradict the poses are not used.

use super::columns::{Names, believe};
use super::raw::{Raw, RawSample};
use super::refusal::{Place, Reason, Refusal};
use super::repair::Repairs;
use super::{Format, MAX_SAMPLES, says_nothing};
use csv::{ErrorKind, Position, Reader, ReaderBuilder, StringRecord, Trim};

const NAMES: [&str; 8] = ["t", "x", "y", "theta", "v", "w", "a", "alpha"];
const REQUIRED: usize = 4;

/// The lines of a table that say something, where they were: the parser skips empty lines, but knows no indented comments.
pub(crate) fn said(text: &str) -> String {
    let lines = text.split('\n');
    let said = lines.map(|line| if says_nothing(line) { "" } else { line });
    said.collect::<Vec<_>>().join("\n")
}

/// A table as people have it, of what [`said`] leaves: spaces about cells say nothing.
pub(crate) fn reader(said: &str) -> Reader<&[u8]> {
    ReaderBuilder::new()
        .trim(Trim::All)
        .from_reader(said.as_bytes())
}

/// Reads the table.
pub(super) fn read(text: &str) -> Result<Raw, Refusal> {
    let text = &*said(text);
    let mut reader = reader(text);
    let header = reader.headers().map_err(|e| broken(text, &e))?.clone();
    let line = line_at(text, header.position());
    let columns = columns(&header, line)?;
    let mut samples = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| broken(text, &e))?;
        let line = line_at(text, record.position());
        let place = Place::sample(line, samples.len());
        if samples.len() == MAX_SAMPLES {
            let reason = Reason::TooManySamples { limit: MAX_SAMPLES };
            return Err(Refusal::new(Format::Csv, place, reason));
        }
        let mut values = [None; NAMES.len()];
        for ((value, column), name) in values.iter_mut().zip(columns).zip(NAMES) {
            let Some(cell) = column.and_then(|c| record.get(c)) else {
                continue;
            };
            let number = cell.parse::<f64>().ok().filter(|v| v.is_finite());
            *value = Some(number.ok_or_else(|| {
                let cell = cell.chars().take(40).collect();
                let place = place.clone().field(name);
                Refusal::new(Format::Csv, place, Reason::NotANumber(cell))
            })?);
        }
        let [Some(t), Some(x), Some(y), Some(theta), v, w, _, _] = values else {
            let reason = Reason::WrongCount {
                found: record.len(),
                expected: header.len(),
            };
            return Err(Refusal::new(Format::Csv, place, reason));
        };
        samples.push(RawSample {
            place,
            t,
            x,
            y,
            theta,
            v,
            w,
        });
    }
    let names = Names {
        speeds: "v",
        omega: "w",
    };
    let mut repairs = Repairs::default();
    believe(&mut samples, names, &mut repairs);
    Ok(Raw {
        format: Format::Csv,
        samples,
        repairs,
    })
}

/// Where each of [`NAMES`] stands.
fn columns(header: &StringRecord, line: usize) -> Result<[Option<usize>; 8], Refusal> {
    let refuse = |name: &str, reason| {
        let name: String = name.chars().take(40).collect();
        Err(Refusal::new(
            Format::Csv,
            Place::line(line).field(name),
            reason,
        ))
    };
    let mut columns = [None; NAMES.len()];
    for (position, name) in header.iter().enumerate() {
        let Some(index) = NAMES.iter().position(|n| n.eq_ignore_ascii_case(name)) else {
            return refuse(name, Reason::ColumnUnknown);
        };
        let column = &mut columns[index];
        if column.is_some() {
            return refuse(name, Reason::ColumnTwice);
        }
        *column = Some(position);
    }
    for (name, column) in NAMES.iter().zip(columns).take(REQUIRED) {
        if column.is_none() {
            return refuse(name, Reason::ColumnMissing);
        }
    }
    Ok(columns)
}

/// A refusal from an error of the CSV reader.
pub(crate) fn broken(text: &str, error: &csv::Error) -> Refusal {
    let place = error
        .position()
        .map_or_else(Place::default, |p| Place::line(line_at(text, Some(p))));
    let reason = match error.kind() {
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => Reason::WrongCount {
            found: *len as usize,
            expected: *expected_len as usize,
        },
        _ => Reason::Malformed(error.to_string()),
    };
    Refusal::new(Format::Csv, place, reason)
}

/// The line of a record: the reader's position is before the empty lines that precede it.
pub(crate) fn line_at(text: &str, position: Option<&Position>) -> usize {
    let Some(position) = position else { return 1 };
    let rest = usize::try_from(position.byte())
        .ok()
        .and_then(|byte| text.get(byte..))
        .unwrap_or_default();
    let skipped = rest.lines().take_while(|line| line.is_empty());
    position.line() as usize + skipped.count()
}
