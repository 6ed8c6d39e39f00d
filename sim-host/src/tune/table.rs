//! A search for people.

use super::knobs::KNOBS;
use super::score::Score;
use super::search::Tuned;
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};

/// Gains before and after.
pub fn gain_table(tuned: &Tuned) -> Table {
    let mut table = begin(&["gain", "unit", "before", "after"]);
    for knob in KNOBS {
        let mut row = vec![Cell::new(knob.key), Cell::new(knob.unit)];
        row.extend(tuned.gains.iter().map(|gains| right(knob.of(gains))));
        table.add_row(row);
    }
    table
}

/// Scores before and after, where the search looked and where it did not.
pub fn score_table(tuned: &Tuned) -> Table {
    let mut table = begin(&[
        "points",
        "training\nbefore",
        "\nafter",
        "unseen\nbefore",
        "\nafter",
    ]);
    let scores = [tuned.training, tuned.unseen];
    let all: Vec<&Score> = scores.iter().flatten().collect();
    for (part, name) in Score::NAMES.iter().enumerate() {
        let mut row = vec![Cell::new(name)];
        let value = |score: &&Score| score.parts().get(part).copied().unwrap_or_default();
        row.extend(all.iter().map(|score| right(value(score))));
        table.add_row(row);
    }
    let mut row = vec![Cell::new("sum")];
    row.extend(all.iter().map(|score| right(score.total())));
    table.add_row(row);
    table
}

fn begin(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let bold = |name: &&str| Cell::new(name).add_attribute(Attribute::Bold);
    table.set_header(header.iter().map(bold));
    table
}

fn right(value: f64) -> Cell {
    Cell::new(format!("{value:.3}")).set_alignment(CellAlignment::Right)
}
