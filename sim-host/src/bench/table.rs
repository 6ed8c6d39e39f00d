//! The benchmark for people.

use super::{
    ALLOWED_S, Class, Flavour, LawKind, Plant, Row, Summary, TIMES_ASKED, Track, instructions,
};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell as Printed, CellAlignment, ContentArrangement, Table};
use std::fmt::Write as _;

/// Titles of the columns after the law. Each has a figure for each base.
pub const HEADER: [&str; 10] = [
    "time : least, median",
    "90 %",
    "time [s]",
    "end [mm]",
    "end [mrad]",
    "RMS / peak off [mm, mm/s]",
    "torque step [%]",
    "rim jerk [m/s³]; work [J]",
    "failed [%]",
    "instructions a tick",
];

/// A cell: texts of the bases, and whether each is better than that of our own law.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell(pub Vec<(String, bool)>);

impl Cell {
    fn of(row: &Row, text: impl Fn(&Summary) -> (String, bool)) -> Self {
        Self(row.bases.iter().map(text).collect())
    }

    /// With marks around what is better.
    fn text(&self, marks: (&str, &str)) -> String {
        let texts = self.0.iter().map(|(text, wins)| match wins {
            true => format!("{}{text}{}", marks.0, marks.1),
            false => text.clone(),
        });
        texts.collect::<Vec<_>>().join(" · ")
    }
}

/// A velocity order has no place to end at.
fn end(summary: &Summary, error: f64) -> String {
    match summary.class.track {
        Track::Velocity => digits(f64::INFINITY),
        _ => digits(1.0e3 * error),
    }
}

/// Three digits; nothing for what is not finite.
fn digits(value: f64) -> String {
    if !value.is_finite() {
        "–".to_owned()
    } else if value.abs() >= 100.0 {
        format!("{value:.0}")
    } else if value.abs() >= 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.2}")
    }
}

/// The cells of a row.
pub fn cells(row: &Row) -> Vec<Cell> {
    let plain = |figure: fn(&Summary) -> String| Cell::of(row, |s| (figure(s), false));
    vec![
        Cell::of(row, |s| (digits(s.ratio.median), s.wins_time)),
        plain(|s| digits(s.ratio.most)),
        plain(|s| digits(s.time_s.median)),
        plain(|s| end(s, s.error_m.median)),
        plain(|s| end(s, s.error_rad.median)),
        Cell::of(row, |s| {
            let (rms, peak) = (1.0e3 * s.rms_m.median, 1.0e3 * s.peak_m.median);
            (
                format!("{} / {}", digits(rms), digits(peak)),
                s.wins_tracking,
            )
        }),
        plain(|s| digits(1.0e2 * s.torque_step.median)),
        plain(|s| format!("{}; {}", digits(s.jerk.median), digits(s.energy_j.median))),
        plain(|s| format!("{:.0}", 100.0 * s.failed as f64 / s.runs.max(1) as f64)),
        Cell(vec![(on_chip(row), false)]),
    ]
}

fn on_chip(row: &Row) -> String {
    let most = instructions(row.law.kind, row.class.track);
    most.map_or_else(|| "–".to_owned(), |most| most.to_string())
}

/// The label of a row; `*` on the front for a base each.
pub fn label(row: &Row) -> String {
    let flavour = match (row.law.kind.gains().is_empty(), row.law.flavour) {
        (false, Flavour::Tuned) => ", tuned",
        _ => "",
    };
    format!("{}{flavour}", row.law.kind.name())
}

fn front(row: &Row) -> String {
    row.bases
        .iter()
        .map(|summary| if summary.on_front { '*' } else { '.' })
        .collect()
}

/// The classes of rows, in order.
pub(super) fn classes(rows: &[Row]) -> Vec<Class> {
    let mut classes: Vec<Class> = rows.iter().map(|row| row.class).collect();
    classes.dedup();
    classes
}

/// For a terminal: a table for each class.
pub fn console(rows: &[Row], class: Class) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let titles = [class.name(), "front".to_owned()];
    let titles = titles.into_iter().chain(HEADER.map(str::to_owned));
    table.set_header(titles.map(|title| Printed::new(title).add_attribute(Attribute::Bold)));
    for row in rows.iter().filter(|row| row.class == class) {
        let mut line = vec![Printed::new(label(row)), Printed::new(front(row))];
        for cell in cells(row) {
            let wins = cell.0.iter().any(|(_, wins)| *wins);
            let printed = Printed::new(cell.text(("!", ""))).set_alignment(CellAlignment::Right);
            line.push(match wins {
                true => printed.add_attribute(Attribute::Bold),
                false => printed,
            });
        }
        table.add_row(line);
    }
    table
}

/// For a page: the better flavour of each rival, in bold what beats our own law.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::new();
    for class in classes(rows) {
        let _ = writeln!(text, "### {}\n", capital(&class.name()));
        let _ = writeln!(text, "| law | {} |", HEADER.join(" | "));
        let _ = writeln!(text, "| --- |{}", " --- |".repeat(HEADER.len()));
        for row in better(rows, class) {
            let cells = cells(row)
                .iter()
                .map(|cell| cell.text(("**", "**")))
                .collect::<Vec<_>>();
            let _ = writeln!(text, "| {} | {} |", label(row), cells.join(" | "));
        }
        text.push('\n');
    }
    text
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Of each law the flavour with fewer failures, then with the better median times, over all bases.
pub fn better(rows: &[Row], class: Class) -> Vec<&Row> {
    let mut kinds: Vec<LawKind> = Vec::new();
    let of_class: Vec<&Row> = rows.iter().filter(|row| row.class == class).collect();
    for row in &of_class {
        if !kinds.contains(&row.law.kind) {
            kinds.push(row.law.kind);
        }
    }
    let cost = |row: &Row| {
        let failed: usize = row.bases.iter().map(|summary| summary.failed).sum();
        let slow: f64 = row
            .bases
            .iter()
            .map(|summary| summary.ratio.median.min(1.0e3))
            .sum();
        (failed, slow)
    };
    let best = |kind: LawKind| {
        let own = of_class.iter().copied().filter(|row| row.law.kind == kind);
        own.reduce(|a, b| {
            let (a_cost, b_cost) = (cost(a), cost(b));
            if b_cost.0 < a_cost.0 || (b_cost.0 == a_cost.0 && b_cost.1 < a_cost.1) {
                b
            } else {
                a
            }
        })
    };
    kinds.into_iter().filter_map(best).collect()
}

/// What is asked of our own law in a class, beside what was measured; and who beats it.
pub fn verdict(rows: &[Row], class: Class, bases: &[String]) -> String {
    let mut text = String::new();
    let of_class = || rows.iter().filter(|row| row.class == class);
    let asked = TIMES_ASKED.iter().find(|(plant, _)| *plant == class.plant);
    if let (Track::Parking, Some((_, asked))) = (class.track, asked) {
        let allowed = if class.plant == Plant::Ideal {
            0.0
        } else {
            ALLOWED_S
        };
        let [median, most, all] = asked;
        let _ = writeln!(
            text,
            "asked of the default law: time less {allowed} s over least time, median {median}, 90 % {most}, all {all}"
        );
        for own in of_class().filter(|row| row.law.kind == LawKind::Default) {
            for summary in &own.bases {
                let spread = if class.plant == Plant::Ideal {
                    summary.ratio
                } else {
                    summary.late
                };
                let holds =
                    spread.median <= *median && spread.most <= *most && spread.worst <= *all;
                let _ = writeln!(
                    text,
                    "  {:12} {} · {} · {}: {}",
                    name(bases, summary),
                    digits(spread.median),
                    digits(spread.most),
                    digits(spread.worst),
                    if holds { "holds" } else { "does not hold" }
                );
            }
        }
    }
    let mut beaten = false;
    for row in of_class() {
        for summary in &row.bases {
            let what = match (summary.wins_time, summary.wins_tracking) {
                (false, false) => continue,
                (true, false) => "sooner",
                (false, true) => "closer",
                (true, true) => "sooner and closer",
            };
            beaten = true;
            let _ = writeln!(text, "{} is {what} on {}", label(row), name(bases, summary));
        }
    }
    let front = of_class()
        .filter(|row| row.law.kind == LawKind::Default)
        .flat_map(|row| &row.bases)
        .filter(|summary| !summary.on_front)
        .map(|summary| name(bases, summary));
    let behind: Vec<&str> = front.collect();
    if !behind.is_empty() {
        let _ = writeln!(
            text,
            "the default law is behind the front on {}",
            behind.join(", ")
        );
    }
    if !beaten && behind.is_empty() {
        let _ = writeln!(text, "no rival is better than the default law");
    }
    text
}

fn name<'a>(bases: &'a [String], summary: &Summary) -> &'a str {
    bases.get(summary.base).map_or("", String::as_str)
}
