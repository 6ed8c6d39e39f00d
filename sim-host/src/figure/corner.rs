//! Where a legend hides least.

use super::legend::{self, Entry, OFF};

/// A corner of a panel, inside the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub right: bool,
    pub top: bool,
}

impl Corner {
    pub const TOP_RIGHT: Self = Self {
        right: true,
        top: true,
    };

    /// The corner whose legend covers the fewest of `points`, top right if in doubt, and how many.
    ///
    /// `range` is that of the axes, `plot` the size of the area between them in pixels.
    pub fn emptiest(
        points: impl Iterator<Item = (f64, f64)>,
        range: ((f64, f64), (f64, f64)),
        entries: &[Entry],
        plot: (f64, f64),
    ) -> (Self, usize) {
        let size = legend_size(entries);
        let (wide, high) = (size.0 / plot.0, size.1 / plot.1);
        let (x, y) = range;
        let corners = [(true, true), (true, false), (false, true), (false, false)]
            .map(|(right, top)| Self { right, top });
        let mut hidden = [0_usize; 4];
        for point in points {
            let across = (point.0 - x.0) / (x.1 - x.0);
            let up = (point.1 - y.0) / (y.1 - y.0);
            for (corner, hidden) in corners.iter().zip(&mut hidden) {
                let beside = if corner.right {
                    across > 1.0 - wide
                } else {
                    across < wide
                };
                let along = if corner.top {
                    up > 1.0 - high
                } else {
                    up < high
                };
                *hidden += usize::from(beside && along);
            }
        }
        let best = corners
            .into_iter()
            .zip(hidden)
            .min_by_key(|(_, hidden)| *hidden);
        best.unwrap_or((corners[0], 0))
    }

    /// What the upper limit of an axis has to become for a legend above everything drawn.
    pub fn room_above(y: (f64, f64), entries: &[Entry], height: f64) -> f64 {
        y.0 + (y.1 - y.0) / (1.0 - (legend_size(entries).1 / height).min(0.5))
    }

    /// Width and height of a legend as shares of those between the axes.
    pub fn legend_share(entries: &[Entry], plot: (f64, f64)) -> (f64, f64) {
        let (wide, high) = legend_size(entries);
        (wide / plot.0, high / plot.1)
    }
}

/// Width and height of a legend with its distance from the axes, and as much on the other side \[px\].
fn legend_size(entries: &[Entry]) -> (f64, f64) {
    let (wide, high) = legend::legend_size(entries);
    (wide + 2.0 * OFF, high + 2.0 * OFF)
}
