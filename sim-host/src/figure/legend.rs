//! What a legend says, and how large it is.

use super::drawing::{Color, Point};
use super::font;
use super::style::SMALL_SIZE;

/// Of a legend: around it, the sample, and from that to its words; its height besides its lines.
pub(super) const PAD: f64 = 10.0;
pub(super) const SAMPLE: f64 = 18.0;
pub(super) const GAP: f64 = 8.0;
pub(super) const FRAME: f64 = 12.5;
pub(super) const LINE: f64 = 1.5 * SMALL_SIZE;
/// From a legend to the axes.
pub(super) const OFF: f64 = 8.0;

/// What is drawn for a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    Triangle,
    TriangleDown,
    Diamond,
    Star,
    Cross,
}

/// A line of a legend.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub label: String,
    pub color: Color,
    /// A line with these dashes without one.
    pub marker: Option<Marker>,
    pub dashes: &'static [f32],
}

/// Such a line.
pub(super) fn entry(
    label: &str,
    color: Color,
    marker: Option<Marker>,
    dashes: &'static [f32],
) -> Entry {
    Entry {
        label: label.to_owned(),
        color,
        marker,
        dashes,
    }
}

/// Width and height of a legend.
pub(super) fn legend_size(entries: &[Entry]) -> Point {
    let widths = entries
        .iter()
        .map(|entry| font::width(&entry.label, SMALL_SIZE));
    let widest = widths.fold(0.0, f64::max);
    (
        2.0 * PAD + SAMPLE + GAP + widest,
        LINE * entries.len() as f64 + FRAME,
    )
}
