//! The study for people.

use super::RunVerdict;
use super::condition::{Expected, Range};
use super::law::ComparedLaw;
use super::study::{Spread, StudyOutcome, StudyRow};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};

/// Titles of the columns after condition and case.
const SETTLING: [&str; 4] = ["T [s]\nexpected", "\nneural", "\nplain", "\ndefault"];
const END: [&str; 5] = [
    "end [mm]\nexpected",
    "\nneural",
    "\nplain",
    "\ndefault",
    "parked [s]\ndefault",
];
const NOISE: [&str; 7] = [
    "σ of moment,\nfollowing\nexpected",
    "[N m]\n\nneural",
    "\n\nplain",
    "\n\ndefault",
    "the same\nat rest\nneural",
    "\n\nplain",
    "\n\ndefault",
];
const PEAKS: [&str; 6] = [
    "peak force\n[N]\nneural",
    "\n\nplain",
    "\n\ndefault",
    "peak moment\n[N m]\nneural",
    "\n\nplain",
    "\n\ndefault",
];

/// Tables with a row per condition and case, none wider than a terminal: when the robot settled
/// within 5 cm and 0.05 rad, where it ended, how much noise reaches the torque, and its peaks. Over
/// many seeds the mean and, behind a stroke, the worst.
pub fn tables(rows: &[StudyRow<'_>]) -> [Table; 4] {
    let settling = tabulate(rows, &SETTLING, |laws, expected| {
        let mut cells = vec![expected_time(expected)];
        cells.extend(each(laws, settled));
        cells
    });
    let ends = tabulate(rows, &END, |laws, expected| {
        let mut cells = vec![expected.final_mm.map_or_else(String::new, |r| range(r, 1))];
        cells.extend(each(laws, end));
        let [_, _, parks] = each(laws, |outcome| time(outcome.parked_s));
        cells.push(parks);
        cells
    });
    let noise = tabulate(rows, &NOISE, |laws, expected| {
        let moment = expected.moment_std_nm;
        let mut cells = vec![moment.map_or_else(String::new, three_digits)];
        cells.extend(each(laws, |o| three_digits(o.following_std.moment)));
        cells.extend(each(laws, |o| three_digits(o.rest_std.moment)));
        cells
    });
    let peaks = tabulate(rows, &PEAKS, |laws, _| {
        let mut cells = each(laws, |o| three_digits(o.peak_force_n)).to_vec();
        cells.extend(each(laws, |o| three_digits(o.peak_moment_nm)));
        cells
    });
    [settling, ends, noise, peaks]
}

fn tabulate(
    rows: &[StudyRow<'_>],
    header: &[&str],
    figures: impl Fn(&[StudyRow<'_>], &Expected) -> Vec<String>,
) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(
        ["condition", "case"]
            .iter()
            .chain(header)
            .map(|name| Cell::new(name).add_attribute(Attribute::Bold)),
    );
    for laws in rows.chunk_by(|a, b| a.condition == b.condition && a.case == b.case) {
        let Some(first) = laws.first() else { continue };
        let mut cells = vec![
            Cell::new(&first.condition.name),
            Cell::new(first.case.name()),
        ];
        let figures = figures(laws, first.case.expected(first.condition));
        let right = |text| Cell::new(text).set_alignment(CellAlignment::Right);
        cells.extend(figures.into_iter().map(right));
        table.add_row(cells);
    }
    table
}

/// A figure of each law; empty for one that did not run.
fn each(laws: &[StudyRow<'_>], text: fn(&StudyOutcome) -> String) -> [String; 3] {
    ComparedLaw::ALL.map(|law| {
        let row = laws.iter().find(|row| row.law == law);
        row.map_or_else(String::new, |row| text(&row.outcome))
    })
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

fn settled(outcome: &StudyOutcome) -> String {
    time(outcome.settling_s)
}

fn time(spread: Option<Spread>) -> String {
    match spread {
        None => "never".to_owned(),
        Some(Spread { mean, worst }) => both(mean, worst, |value| format!("{value:.2}")),
    }
}

fn end(outcome: &StudyOutcome) -> String {
    let Spread { mean, worst } = outcome.final_m;
    let distance = both(mean, worst, |value| three_digits(1.0e3 * value));
    match outcome.verdict {
        RunVerdict::Arrived => distance,
        verdict if outcome.runs > 1 => {
            let failed = outcome.runs - outcome.arrived;
            format!("{}: {failed} of {}", verdict.name(), outcome.runs)
        }
        RunVerdict::Missed => format!("{distance} !"),
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

/// A figure with three digits, for tables.
pub fn three_digits(value: f64) -> String {
    if value >= 100.0 {
        format!("{value:.0}")
    } else if value >= 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.2}")
    }
}
