//! Five panels in the layout of the paper's Figs. 3 and 4.
//!
//! (a) reference and real trajectories, (b) posture errors, (c) actual and desired linear
//! velocity, (d) actual and desired angular velocity, (e) force and moment. The first run is
//! drawn strong, a second one thin and pale below it.

mod axis;
mod bench;
mod chart;
mod corner;
mod drawing;
mod font;
// The build script runs it.
#[cfg(test)]
#[allow(dead_code)]
mod lean_font;
mod legend;
mod limits;
mod notes;
mod panels;
mod png;
mod robustness;
mod style;
mod thin_out;
mod time_panel;

pub use bench::pareto;
pub use drawing::Drawing;
pub use robustness::robustness;
pub use thin_out::thin_out;

use crate::trace::{self, Trace, TraceRow};

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
    /// The pixels cannot be encoded.
    #[error("the PNG cannot be encoded: {0}")]
    Png(String),
}

/// The row from which a run parks, if it does not from the start, and what made it.
fn last_parking(trace: &Trace) -> Option<(usize, &'static str)> {
    let row = trace
        .parks_from()
        .filter(|row| !trace.parks_at_once(*row))?;
    let handed_over = trace
        .hand_over
        .is_some_and(|hand_over| hand_over.row == row);
    Some((
        row,
        if handed_over {
            "hand-over"
        } else {
            "goal given"
        },
    ))
}

/// Why a base began to stop in this row. In figures an underscore begins a subscript.
fn stop_name(row: &TraceRow) -> String {
    let cause = row.base.map(|base| trace::cause(&base.cause));
    format!("stop, {}", cause.unwrap_or_default().replace('_', " "))
}

/// Draws a run, and another one to compare it with.
///
/// # Errors
/// [`FigureError::Empty`] if a trace has no rows.
pub fn five_panels(
    title: &str,
    main: Labelled<'_>,
    other: Option<Labelled<'_>>,
) -> Result<Drawing, FigureError> {
    if main.trace.rows.is_empty() || other.is_some_and(|other| other.trace.rows.is_empty()) {
        return Err(FigureError::Empty);
    }
    let (width, height) = style::CELL;
    // The torques take the full width of the last row.
    let wide = 2.0 * width + style::SPACING;
    Ok(chart::sheet(
        title,
        vec![
            (
                style::FIRST_ROW,
                vec![
                    (width, Some("(a)"), panels::trajectories(main, other)),
                    (width, Some("(b)"), panels::errors(main, other)),
                ],
            ),
            (
                height,
                vec![
                    (width, Some("(c)"), panels::linear_velocity(main, other)),
                    (width, Some("(d)"), panels::angular_velocity(main, other)),
                ],
            ),
            (
                height,
                vec![(wide, Some("(e)"), panels::torques(main, other))],
            ),
        ],
    ))
}
