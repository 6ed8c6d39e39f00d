//! Metrics side by side, for people.

use crate::metrics::{Metrics, PARKED, SETTLED};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};

/// Metrics with the name of their column.
#[derive(Clone, Copy, Debug)]
pub struct Column<'a> {
    /// For example `neural`.
    pub label: &'a str,
    /// The figures.
    pub metrics: &'a Metrics,
}

/// How a figure is written.
#[derive(Clone, Copy)]
enum Style {
    /// Times.
    Seconds,
    /// Metres or radians, in thousandths.
    Milli,
    /// Everything else: four digits.
    Plain,
}

/// Nothing if the figure does not apply to the run, `Some(None)` for "never".
type Pick = fn(&Metrics) -> Option<Option<f64>>;

/// Rows of the table; a name without a figure heads a group.
fn rows() -> Vec<(String, Option<(Style, Pick)>)> {
    use Style::{Milli, Plain, Seconds};
    let row = |name: &str, style, pick: Pick| (name.to_owned(), Some((style, pick)));
    let head = |name: &str| (name.to_owned(), None);
    let band = |limit: f64| format!("{:.0} cm, {limit} rad", 100.0 * limit);
    vec![
        (
            format!("settling time ({}) [s]", band(SETTLED)),
            Some((Seconds, |m| Some(m.settling_s))),
        ),
        (
            format!("parked after hand-over ({}) [s]", band(PARKED)),
            Some((Seconds, |m| Some(m.hand_over?.parked_after_s))),
        ),
        head("pose error, norm [mm, mrad]"),
        row("  before the hand-over", Milli, |m| {
            Some(Some(m.hand_over?.error_before.norm))
        }),
        row("  after it (pulse)", Milli, |m| {
            Some(Some(m.hand_over?.error_after.norm))
        }),
        row("  at the end", Milli, |m| Some(Some(m.final_error.norm))),
        row("overshoot past the target [mm]", Milli, |m| {
            Some(Some(m.hand_over?.overshoot_m))
        }),
        head("peak"),
        row("  v [m/s]", Plain, |m| Some(Some(m.speed_m_s.peak))),
        row("  w [rad/s]", Plain, |m| Some(Some(m.turn_rate_rad_s.peak))),
        row("  force [N]", Plain, |m| Some(Some(m.force_n.peak))),
        row("  moment [N m]", Plain, |m| Some(Some(m.moment_nm.peak))),
        row("  right wheel [N m]", Plain, |m| {
            Some(Some(m.torque_right_nm.peak))
        }),
        row("  left wheel [N m]", Plain, |m| {
            Some(Some(m.torque_left_nm.peak))
        }),
        head("largest change per tick"),
        row("  v [m/s]", Plain, |m| {
            Some(Some(m.speed_m_s.largest_change_per_tick))
        }),
        row("  w [rad/s]", Plain, |m| {
            Some(Some(m.turn_rate_rad_s.largest_change_per_tick))
        }),
        row("  force [N]", Plain, |m| {
            Some(Some(m.force_n.largest_change_per_tick))
        }),
        row("  moment [N m]", Plain, |m| {
            Some(Some(m.moment_nm.largest_change_per_tick))
        }),
        row("  right wheel [N m]", Plain, |m| {
            Some(Some(m.torque_right_nm.largest_change_per_tick))
        }),
        row("  left wheel [N m]", Plain, |m| {
            Some(Some(m.torque_left_nm.largest_change_per_tick))
        }),
        head("torque step at the start"),
        row("  force [N]", Plain, |m| {
            Some(Some(m.start_torque_step.force_n))
        }),
        row("  moment [N m]", Plain, |m| {
            Some(Some(m.start_torque_step.moment_nm))
        }),
        head("torque step at the hand-over"),
        row("  force [N]", Plain, |m| {
            Some(Some(m.hand_over?.torque_step.force_n))
        }),
        row("  moment [N m]", Plain, |m| {
            Some(Some(m.hand_over?.torque_step.moment_nm))
        }),
    ]
}

/// A table with one column per run; with two runs, the ratio of the second to the first as well.
pub fn side_by_side(columns: &[Column<'_>]) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let bold = |text: &str| Cell::new(text).add_attribute(Attribute::Bold);
    let mut header = vec![Cell::new("")];
    for column in columns {
        header.push(bold(column.label).set_alignment(CellAlignment::Right));
    }
    if let [first, second] = columns {
        let title = format!("{} : {}", second.label, first.label);
        header.push(bold(&title).set_alignment(CellAlignment::Right));
    }
    table.set_header(header);
    for (name, figure) in rows() {
        let Some((style, pick)) = figure else {
            table.add_row(vec![Cell::new(name)]);
            continue;
        };
        let values: Vec<_> = columns.iter().map(|column| pick(column.metrics)).collect();
        // A row without any figure (no hand-over) says nothing.
        if values.iter().all(Option::is_none) {
            continue;
        }
        let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
        let mut cells = vec![Cell::new(name)];
        cells.extend(values.iter().map(|value| right(text(*value, style))));
        if let [first, second] = values[..] {
            cells.push(right(ratio(first.flatten(), second.flatten())));
        }
        table.add_row(cells);
    }
    table
}

fn text(value: Option<Option<f64>>, style: Style) -> String {
    let Some(value) = value else {
        return String::new();
    };
    match (value, style) {
        (None, _) => "never".to_owned(),
        (Some(value), Style::Seconds) => format!("{value:.3}"),
        (Some(value), Style::Milli) => format!("{:.2}", 1.0e3 * value),
        (Some(value), Style::Plain) => four_digits(value),
    }
}

fn four_digits(value: f64) -> String {
    let size = value.abs();
    if size < 1.0e-9 {
        // Rounding of the torque, not a torque.
        "0".to_owned()
    } else if size < 1.0e-3 {
        format!("{value:.1e}")
    } else if size < 1.0 {
        format!("{value:.4}")
    } else if size < 100.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.0}")
    }
}

/// Magnitudes only: a step of −64 is as large as one of 64.
fn ratio(first: Option<f64>, second: Option<f64>) -> String {
    match (first, second) {
        (Some(first), Some(second)) => {
            let (first, second) = (first.abs(), second.abs());
            if first < 1.0e-9 && second < 1.0e-9 {
                String::new()
            } else if first < 1.0e-9 || second / first >= 1.0e4 {
                "> 10000".to_owned()
            } else if second / first >= 100.0 {
                format!("{:.0}", second / first)
            } else {
                format!("{:.2}", second / first)
            }
        }
        _ => String::new(),
    }
}
