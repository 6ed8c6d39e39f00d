//! The benchmark: time beside exactness, a panel for each base, and the front of both.

use super::FigureError;
use super::style::{self, Panel, entry};
use super::typeset;
use crate::bench::{Class, LawKind, Row, Summary, better};
use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use std::sync::Arc;

/// Width of a panel, of one with the legend beside it, and height of all \[px\].
const WIDTHS: (f64, f64) = (470.0, 740.0);
const HEIGHT: f64 = 430.0;
/// Where a law that never arrives is drawn, beyond the slowest that does.
const NEVER: f64 = 1.6;
/// Of the line along the front.
const FRONT: &str = "#bbbbbb";
/// Finer than this nothing differs \[mm, or mm/s\].
const FINEST: f64 = 0.01;

/// Colour and mark of a law.
const fn look(kind: LawKind) -> (&'static str, MarkerShape) {
    use MarkerShape as M;
    match kind {
        LawKind::Default => ("#d55e00", M::Star),
        LawKind::TurnDriveTurn => ("#0072b2", M::Square),
        LawKind::Ramsete => ("#009e73", M::Triangle),
        LawKind::Ltv => ("#009e73", M::TriangleDown),
        LawKind::Mpc => ("#009e73", M::Diamond),
        LawKind::Graceful => ("#cc79a7", M::Circle),
        LawKind::GracefulOnTheWay => ("#cc79a7", M::Diamond),
        LawKind::PurePursuit => ("#cc79a7", M::Square),
        LawKind::Aicardi => ("#e69f00", M::Circle),
        LawKind::Samson => ("#e69f00", M::Triangle),
        LawKind::TwoPids => ("#0072b2", M::Circle),
        LawKind::Neural => ("#56b4e9", M::Diamond),
        LawKind::Plain => ("#56b4e9", M::TriangleDown),
        LawKind::HeadingHeld => ("#d55e00", M::Diamond),
        LawKind::RateLimits => ("#0072b2", M::Circle),
    }
}

/// The Pareto figure of a class, as SVG.
///
/// # Errors
/// [`FigureError::Empty`] if no law ran.
pub fn pareto(rows: &[Row], class: Class, bases: &[String]) -> Result<String, FigureError> {
    let rows = better(rows, class);
    let count = rows.first().map_or(0, |row| row.bases.len());
    if count == 0 {
        return Err(FigureError::Empty);
    }
    let panels: Vec<Panel> = (0..count)
        .map(|at| panel(&rows, at, count, bases))
        .collect();
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let scene = Figure::new(1, count)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(WIDTHS.0, HEIGHT)
        .with_col_width(count - 1, WIDTHS.1)
        .with_spacing(style::SPACING)
        .with_title(class.name())
        .with_title_size(style::TITLE_SIZE)
        .render();
    Ok(typeset::subscripts(&SvgBackend::new().render_scene(&scene)))
}

fn panel(rows: &[&Row], at: usize, count: usize, bases: &[String]) -> Panel {
    let own: Vec<&Summary> = rows.iter().filter_map(|row| row.bases.get(at)).collect();
    let times = own.iter().map(|summary| summary.ratio.median);
    let slowest = times.filter(|time| time.is_finite()).fold(1.2, f64::max);
    let never = NEVER * slowest;
    let place = |summary: &Summary| {
        let time = summary.ratio.median;
        let off = (1.0e3 * summary.exactness()).max(FINEST);
        (if time.is_finite() { time } else { never }, off)
    };
    let points: Vec<(f64, f64)> = own.iter().map(|summary| place(summary)).collect();
    let finite = || {
        points
            .iter()
            .map(|(_, off)| *off)
            .filter(|off| off.is_finite())
    };
    let (low, high) = (
        finite().fold(1.0, f64::min) * 0.6,
        finite().fold(10.0, f64::max) * 1.8,
    );
    let least = points.iter().map(|(time, _)| *time).fold(1.0, f64::min);
    let x = (0.95 * least, 1.1 * never);
    let mut plots: Vec<Plot> = Vec::new();
    let mut front: Vec<(f64, f64)> = own
        .iter()
        .filter(|summary| summary.on_front)
        .map(|summary| place(summary))
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let line = LinePlot::new().with_data(front).with_color(FRONT);
    plots.push(line.with_stroke_width(1.5).into());
    for summary in &own {
        let (time, off) = place(summary);
        let (color, shape) = look(summary.law.kind);
        let shape = if summary.ratio.median.is_finite() {
            shape
        } else {
            MarkerShape::Cross
        };
        let plot = ScatterPlot::new()
            .with_data(vec![(time, off.min(high))])
            .with_marker(shape)
            .with_size(if summary.law.kind == LawKind::Default {
                7.0
            } else {
                5.0
            })
            .with_color(color);
        plots.push(plot.into());
    }
    let title = bases.get(own.first().map_or(at, |summary| summary.base));
    let mut layout = style::layout(x, (low, high))
        .with_log_x()
        .with_log_y()
        .with_x_tick_format(TickFormat::Custom(Arc::new(plain)))
        .with_y_tick_format(TickFormat::Custom(Arc::new(plain)))
        .with_title(title.map_or("", String::as_str))
        .with_x_label("time : least time, median; × never");
    if at == 0 {
        layout = layout.with_y_label(y_label(&own));
    }
    if at + 1 == count {
        layout = with_legend(layout, rows);
    }
    (plots, layout)
}

fn y_label(own: &[&Summary]) -> &'static str {
    use crate::bench::Track;
    match own.first().map(|summary| summary.class.track) {
        Some(Track::Parking) => "distance at the end [mm], median",
        Some(Track::Velocity) => "rim beside its order, RMS [mm/s]",
        _ => "off the reference, RMS [mm]",
    }
}

fn with_legend(layout: Layout, rows: &[&Row]) -> Layout {
    let law = |row: &&Row| {
        let (color, shape) = look(row.law.kind);
        entry(
            &crate::bench::label(row),
            color,
            LegendShape::Marker(shape),
            None,
        )
    };
    let front = entry("front", FRONT, LegendShape::Line, None);
    let entries: Vec<LegendEntry> = rows.iter().map(law).chain([front]).collect();
    layout
        .with_legend_entries(entries)
        .with_legend_position(LegendPosition::OutsideRightTop)
}

fn plain(value: f64) -> String {
    format!("{value}")
}
