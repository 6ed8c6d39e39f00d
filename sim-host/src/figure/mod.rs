//! Five panels in the layout of the paper's Figs. 3 and 4.
//!
//! (a) reference and real trajectories, (b) posture errors, (c) actual and desired linear
//! velocity, (d) actual and desired angular velocity, (e) force and moment. The first run is
//! drawn strong, a second one thin and pale below it.

mod bench;
mod corner;
// The build script runs it.
#[cfg(test)]
#[allow(dead_code)]
mod lean_font;
mod limits;
mod notes;
mod panels;
mod png;
mod robustness;
mod style;
mod thin_out;
mod time_panel;
mod typeset;

pub use bench::pareto;
pub use png::png;
pub use robustness::robustness;
pub use thin_out::thin_out;

use crate::trace::Trace;
use kuva::backend::svg::SvgBackend;
use kuva::render::figure::{Figure, LabelConfig};

/// A run with the name that the legends show.
#[derive(Clone, Copy, Debug)]
pub struct Labelled<'a> {
    /// For example `neural`.
    pub label: &'a str,
    /// The run.
    pub trace: &'a Trace,
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A trace without rows, or a picture without size.
    #[error("there is nothing to draw")]
    Empty,
    /// The SVG cannot be read back.
    #[error("the SVG cannot be rendered: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// The pixels cannot be encoded.
    #[error("the PNG cannot be encoded: {0}")]
    Png(String),
}

/// Draws a run, and another one to compare it with, as SVG.
///
/// # Errors
/// [`FigureError::Empty`] if a trace has no rows.
pub fn five_panels(
    title: &str,
    main: Labelled<'_>,
    other: Option<Labelled<'_>>,
) -> Result<String, FigureError> {
    if main.trace.rows.is_empty() || other.is_some_and(|other| other.trace.rows.is_empty()) {
        return Err(FigureError::Empty);
    }
    let panels = [
        panels::trajectories(main, other),
        panels::errors(main, other),
        panels::linear_velocity(main, other),
        panels::angular_velocity(main, other),
        panels::torques(main, other),
    ];
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let (width, height) = style::CELL;
    let scene = Figure::new(3, 2)
        // The torques take the full width of the last row.
        .with_structure(vec![vec![0], vec![1], vec![2], vec![3], vec![4, 5]])
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(width, height)
        .with_row_height(0, style::FIRST_ROW)
        .with_spacing(style::SPACING)
        .with_labels_custom(
            vec!["(a)", "(b)", "(c)", "(d)", "(e)"],
            LabelConfig {
                size: style::LABEL_SIZE,
                ..LabelConfig::default()
            },
        )
        .with_title(title)
        .with_title_size(style::TITLE_SIZE)
        .render();
    Ok(typeset::subscripts(&SvgBackend::new().render_scene(&scene)))
}
