//! The study for people.

use super::Verdict;
use super::condition::{Expected, Range};
use super::law::Law;
use super::study::{Outcome, Row, Spread};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};

const HEADER: [&str; 14] = [
    "condition",
    "case",
    "T [s]\nexpected",
    "\nneural",
    "\nplain",
    "\ndefault",
    "end [mm]\nexpected",
    "\nneural",
    "\nplain",
    "\ndefault",
    "parked [s]\ndefault",
    "τ_2 at rest [N m]\nneural",
    "\nplain",
    "\ndefault",
];

/// A table with a row per condition and case. T: settled within 5 cm and 0.05 rad. Over many seeds
/// the mean and, behind a stroke, the worst.
pub fn table(rows: &[Row<'_>]) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(HEADER.map(|name| Cell::new(name).add_attribute(Attribute::Bold)));
    let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
    for laws in rows.chunk_by(|a, b| a.condition == b.condition && a.case == b.case) {
        let Some(first) = laws.first() else { continue };
        let expected = first.case.expected(first.condition);
        let each = |text: fn(&Outcome) -> String| {
            let of = move |law| laws.iter().find(|row| row.law == law);
            Law::ALL.map(|law| right(of(law).map_or_else(String::new, |row| text(&row.outcome))))
        };
        let mut cells = vec![
            Cell::new(&first.condition.name),
            Cell::new(first.case.name()),
            right(expected_time(expected)),
        ];
        cells.extend(each(settled));
        cells.push(right(
            expected.final_mm.map_or_else(String::new, |r| range(r, 1)),
        ));
        cells.extend(each(end));
        let [_, _, parks] = each(|outcome| time(outcome.parked_s));
        cells.push(parks);
        cells.extend(each(|outcome| three_digits(outcome.moment_std_nm)));
        table.add_row(cells);
    }
    table
}

fn expected_time(expected: &Expected) -> String {
    match expected.settling_s {
        Some(times) => range(times, 2),
        None if expected.fails => "never".to_owned(),
        None => String::new(),
    }
}

fn range((low, high): Range, digits: usize) -> String {
    if low < high {
        format!("{low:.digits$}–{high:.digits$}")
    } else {
        format!("{low:.digits$}")
    }
}

fn settled(outcome: &Outcome) -> String {
    time(outcome.settling_s)
}

fn time(spread: Option<Spread>) -> String {
    match spread {
        None => "never".to_owned(),
        Some(Spread { mean, worst }) => both(mean, worst, |value| format!("{value:.2}")),
    }
}

fn end(outcome: &Outcome) -> String {
    let Spread { mean, worst } = outcome.final_m;
    let distance = both(mean, worst, |value| three_digits(1.0e3 * value));
    match outcome.verdict {
        Verdict::Arrived => distance,
        verdict if outcome.runs > 1 => {
            let failed = outcome.runs - outcome.arrived;
            format!("{}: {failed} of {}", verdict.name(), outcome.runs)
        }
        Verdict::Missed => format!("{distance} !"),
        verdict => verdict.name().to_owned(),
    }
}

fn both(mean: f64, worst: f64, text: impl Fn(f64) -> String) -> String {
    let (mean, worst) = (text(mean), text(worst));
    if mean == worst {
        mean
    } else {
        format!("{mean} / {worst}")
    }
}

fn three_digits(value: f64) -> String {
    if value >= 100.0 {
        format!("{value:.0}")
    } else if value >= 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.2}")
    }
}
