//! Words inside a panel.

use super::corner::Corner;
use super::style::{self, GREY};
use kuva::plot::annotations::{ReferenceLine, TextAnnotation};
use kuva::render::layout::Layout;

/// A panel with its axes fixed and its legend placed.
pub(super) struct Canvas {
    /// Axis limits.
    pub x: (f64, f64),
    pub y: (f64, f64),
    /// Width between the axes \[px\].
    pub width: f64,
    pub legend: Corner,
    /// Height of the legend, as a share of the panel's.
    pub legend_height: f64,
    /// When the robot was handed over.
    pub hand_over: Option<f64>,
}

/// Half the width of "P = 9.5 s" with some air \[px\].
const HALF_LABEL: f64 = 40.0;

impl Canvas {
    /// Marks the hand-over, beside its line and away from the legend.
    pub fn mark_hand_over(&self, layout: Layout) -> Layout {
        let Some(time) = self.hand_over else {
            return layout;
        };
        let line = ReferenceLine::vertical(time)
            .with_color(GREY)
            .with_dasharray("2 3");
        let aside = HALF_LABEL / self.width;
        let place = self.across(time);
        let fits_left = place > 2.0 * aside;
        let fits_right = place < 1.0 - 2.0 * aside;
        let left = fits_left && (self.legend.right || !fits_right);
        let place = if left { place - aside } else { place + aside };
        // A time of the user's, without the noise of its last digits.
        let text = format!("P = {} s", (time * 1.0e3).round() / 1.0e3);
        layout
            .with_reference_line(line)
            .with_annotation(self.text(text, place, 0.93))
    }

    /// A remark at the upper or lower end, clear of the line of the hand-over and of the legend.
    pub fn remark(&self, layout: Layout, text: String, above: bool) -> Layout {
        let (place, right) = match self.hand_over.map(|time| self.across(time)) {
            Some(line) if line < 0.5 => (0.5 * (line + 1.0), true),
            Some(line) => (0.5 * line, false),
            None if self.legend.right => (0.36, false),
            None => (0.64, true),
        };
        let shares_corner = self.legend.right == right && self.legend.top == above;
        let height = if shares_corner {
            self.legend_height
        } else {
            0.0
        };
        let up = if above { 0.86 - height } else { 0.05 + height };
        layout.with_annotation(self.text(text, place, up))
    }

    fn across(&self, time: f64) -> f64 {
        (time - self.x.0) / (self.x.1 - self.x.0)
    }

    fn text(&self, text: String, across: f64, up: f64) -> TextAnnotation {
        let x = self.x.0 + across * (self.x.1 - self.x.0);
        let y = self.y.0 + up * (self.y.1 - self.y.0);
        TextAnnotation::new(text, x, y).with_font_size(style::SMALL_SIZE)
    }
}
