//! Sizes, colours and strokes.

use super::drawing::Color;

/// Width and height of a panel.
pub(super) const CELL: (f64, f64) = (620.0, 400.0);
/// Height of the first row, which has the plane in it.
pub(super) const FIRST_ROW: f64 = 470.0;
/// What axis names and numbers take of a panel's width and height.
pub(super) const MARGINS: (f64, f64) = (90.0, 110.0);
/// Between panels.
pub(super) const SPACING: f64 = 14.0;
/// Font size of the figure's title.
pub(super) const TITLE_SIZE: f64 = 19.0;
/// Font size of panel and axis names.
pub(super) const LABEL_SIZE: f64 = 15.0;
/// Font size of tick numbers and legends.
pub(super) const SMALL_SIZE: f64 = 13.0;

/// A signal's colour, for the main run and for the one below it.
#[derive(Clone, Copy)]
pub(super) struct Ink {
    pub strong: Color,
    pub pale: Color,
}

/// Okabe and Ito's palette: distinguished with any colour vision, and in grey by its lightness.
pub(super) const BLUE: Ink = Ink {
    strong: "#0072b2",
    pale: "#86bcdd",
};
pub(super) const ORANGE: Ink = Ink {
    strong: "#d55e00",
    pale: "#efb083",
};
pub(super) const GREEN: Ink = Ink {
    strong: "#009e73",
    pale: "#86d3bd",
};
/// Velocities that were ordered, in the colour of the reference.
pub(super) const ORDER: Ink = Ink {
    strong: GREY,
    pale: LEGEND_EDGE,
};
/// The reference, and everything that is not a signal.
pub(super) const GREY: &str = "#777777";
pub(super) const BLACK: &str = "#222222";
pub(super) const AXIS: &str = "#444444";
pub(super) const GRID: &str = "#e6e6e6";
pub(super) const LEGEND_EDGE: &str = "#cccccc";
pub(super) const PAPER: &str = "#ffffff";

/// Stroke of the main run and of the one below it.
pub(super) const STRONG: f64 = 2.2;
pub(super) const PALE: f64 = 1.2;

/// The stroke of the main run and of the one below it.
pub(super) fn stroke(main: bool) -> f64 {
    if main { STRONG } else { PALE }
}
