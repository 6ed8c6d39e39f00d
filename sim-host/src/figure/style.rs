//! Sizes, colours, strokes, and what a panel is made of.

use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::theme::Theme;
use std::sync::Arc;

/// Curves and the axes that they are drawn on.
pub(super) type Panel = (Vec<Plot>, Layout);

/// Width and height of a panel.
pub(super) const CELL: (f64, f64) = (620.0, 400.0);
/// Height of the first row, which has the plane in it.
pub(super) const FIRST_ROW: f64 = 470.0;
/// What axis names and numbers take of a panel's width and height.
pub(super) const MARGINS: (f64, f64) = (90.0, 110.0);
/// Between panels.
pub(super) const SPACING: f64 = 14.0;
/// Font size of the figure's title.
pub(super) const TITLE_SIZE: u32 = 19;
/// Font size of panel and axis names.
pub(super) const LABEL_SIZE: u32 = 15;
/// Font size of tick numbers and legends.
pub(super) const SMALL_SIZE: u32 = 13;

/// A signal's colour, for the main run and for the one below it.
#[derive(Clone, Copy)]
pub(super) struct Ink {
    pub strong: &'static str,
    pub pale: &'static str,
}

/// Okabe and Ito's palette: told apart with any colour vision, and in grey by its lightness.
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
/// The reference, and everything that is not a signal.
pub(super) const GREY: &str = "#777777";
pub(super) const BLACK: &str = "#222222";

/// Stroke of the main run and of the one below it.
pub(super) const STRONG: f64 = 2.2;
pub(super) const PALE: f64 = 1.2;

/// A layout with this figure's look.
pub(super) fn layout(x: (f64, f64), y: (f64, f64)) -> Layout {
    let theme = Theme {
        grid_color: "#e6e6e6".into(),
        axis_color: "#444444".into(),
        tick_color: "#444444".into(),
        legend_border: "#cccccc".into(),
        ..Theme::light()
    };
    Layout::new(x, y)
        .with_x_axis_min(x.0)
        .with_x_axis_max(x.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1)
        .with_theme(theme)
        .with_box_axes()
        .with_title_size(LABEL_SIZE)
        .with_label_size(LABEL_SIZE)
        .with_tick_size(SMALL_SIZE)
        .with_tick_format(TickFormat::Custom(Arc::new(true_minus)))
        .with_body_size(SMALL_SIZE)
}

/// A minus, not a hyphen.
fn true_minus(value: f64) -> String {
    TickFormat::Auto.format(value).replace('-', "−")
}

/// A line of a legend.
pub(super) fn entry(
    label: &str,
    color: &str,
    shape: LegendShape,
    dashes: Option<&str>,
) -> LegendEntry {
    LegendEntry {
        label: label.to_owned(),
        color: color.to_owned(),
        shape,
        dasharray: dashes.map(str::to_owned),
    }
}

/// The stroke of the main run and of the one below it.
pub(super) fn stroke(main: bool) -> f64 {
    if main { STRONG } else { PALE }
}
