//! What was identified, for people.

use super::coverage::Rate;
use super::{Entry, Identified, Verdict};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};
use std::fmt::Write as _;

/// A table of how often intervals hold the true values in `runs` logs.
pub fn coverage(rates: &[Rate], runs: usize) -> String {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let bold = |text: &str| Cell::new(text).add_attribute(Attribute::Bold);
    table.set_header(
        [
            "",
            "true",
            "numbers",
            "within",
            "95 % of that",
            "half width",
            "error",
        ]
        .map(bold),
    );
    for rate in rates {
        let mut cells = vec![
            rate.name.clone(),
            format!("{:.4e}", rate.truth),
            format!("{} of {runs}", rate.given),
        ];
        if rate.given > 0 {
            let [low, high] = rate.interval().map(|share| 100.0 * share);
            cells.extend([
                format!("{} = {:.1} %", rate.within, 100.0 * rate.share()),
                format!("{low:.1} to {high:.1} %"),
                format!("{:.2} %", 100.0 * rate.half_width),
                format!("{:+.2} %", 100.0 * rate.error),
            ]);
        }
        table.add_row(cells);
    }
    format!("{table}\nhalf width and error: means over the true value\n")
}

/// A table of all quantities, then why some are not in it, then warnings.
pub fn text(found: &Identified) -> String {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let bold = |text: &str| Cell::new(text).add_attribute(Attribute::Bold);
    table.set_header(vec![bold(""), bold("value"), bold("95 %"), bold("unit")]);
    for entry in found.quantities.iter().chain(&found.combinations) {
        let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
        let (value, interval) = match &entry.verdict {
            Verdict::Stated { value } => (value.to_string(), "stated".to_owned()),
            Verdict::Identified { value, half_width } => both(*value, *half_width),
            Verdict::NotIdentifiable { .. } => ("not identifiable".to_owned(), String::new()),
        };
        table.add_row(vec![
            Cell::new(&entry.name),
            right(value),
            right(interval),
            Cell::new(entry.unit),
        ]);
    }
    let mut text = format!("{table}\n");
    // Writing to a string cannot fail.
    for (names, why, would_help) in reasons(&found.quantities) {
        let _ = writeln!(text, "{}: not identifiable: {why}", names.join(", "));
        let _ = writeln!(text, "  would help: {}", would_help.join("; or "));
    }
    for warning in &found.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

type Reason<'a> = (Vec<&'a str>, &'a str, Vec<String>);

/// Reasons, each once, with the quantities that it holds for.
fn reasons(entries: &[Entry]) -> Vec<Reason<'_>> {
    let mut all: Vec<Reason<'_>> = Vec::new();
    for entry in entries {
        if let Verdict::NotIdentifiable { why, would_help } = &entry.verdict {
            // The last way, to state the quantity itself, differs by name only.
            let own = format!("--known {}=...", entry.name);
            let mut ways = would_help.clone();
            ways.retain(|way| *way != own);
            ways.push("--known with the value itself".to_owned());
            match all.iter_mut().find(|(_, w, h)| w == why && *h == ways) {
                Some((names, _, _)) => names.push(&entry.name),
                None => all.push((vec![&entry.name], why, ways)),
            }
        }
    }
    all
}

/// Value and half width with as many places as the half width's two leading digits have.
fn both(value: f64, half_width: f64) -> (String, String) {
    let places = 1.0 - half_width.max(1.0e-12).log10().floor();
    // Half widths of 1e-12 to 1e1 and above: 0 to 13 places.
    let places = places.clamp(0.0, 13.0) as usize;
    (
        format!("{value:.places$}"),
        format!("± {half_width:.places$}"),
    )
}
