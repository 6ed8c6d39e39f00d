//! The study of robustness: a row per condition, a mark per law and case.

use super::FigureError;
use super::style::{self, BLACK, BLUE, GREEN, GREY, ORANGE};
use super::style::{Panel, entry};
use super::typeset;
use crate::robustness::{Case, ComparedLaw, RunVerdict, StudyOutcome, StudyRow};
use kuva::backend::svg::SvgBackend;
use kuva::plot::annotations::ReferenceLine;
use kuva::plot::legend::{LegendPosition, LegendShape};
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use std::sync::Arc;

/// Height of a condition's row, and of what is above and below all rows \[px\].
const ROW: f64 = 27.0;
const FRAME: f64 = 150.0;
/// Widths of the panel with the names and of the one without \[px\].
const WIDTHS: (f64, f64) = (700.0, 560.0);
/// Range of distances \[mm\]: below a hundredth nothing differs, above a metre all is lost.
const DISTANCES: (f64, f64) = (0.01, 1000.0);
/// Where a robot that is lost is drawn, and a distance below the range \[mm\].
const LOST_AT: f64 = 700.0;
const LEAST_AT: f64 = 0.0115;
/// Range of settling times \[s\], and where a robot that never settles is drawn.
const TIMES: (f64, f64) = (4.0, 9.6);
const NEVER_AT: f64 = 9.3;

/// Distance to the goal at the end and settling time, side by side, as SVG.
///
/// # Errors
/// [`FigureError::Empty`] if there are no rows.
pub fn robustness(rows: &[StudyRow<'_>]) -> Result<String, FigureError> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.condition.name.as_str()).collect();
    names.dedup();
    if names.is_empty() {
        return Err(FigureError::Empty);
    }
    let (ends, times) = (ends(rows, &names), times(rows, &names));
    let height = FRAME + ROW * names.len() as f64;
    let scene = Figure::new(1, 2)
        .with_plots(vec![ends.0, times.0])
        .with_layouts(vec![ends.1, times.1])
        .with_cell_size(WIDTHS.0, height)
        .with_col_width(1, WIDTHS.1)
        .with_spacing(style::SPACING)
        .with_title("The paper's cases under what is wrong with a real robot")
        .with_title_size(style::TITLE_SIZE)
        .render();
    Ok(typeset::subscripts(&SvgBackend::new().render_scene(&scene)))
}

fn ends(rows: &[StudyRow<'_>], names: &[&str]) -> Panel {
    let place = |outcome: &StudyOutcome| {
        let lost = outcome.verdict > RunVerdict::Missed;
        let mm = |metres: f64| (1.0e3 * metres).clamp(LEAST_AT, LOST_AT);
        let (mean, worst) = (mm(outcome.final_m.mean), mm(outcome.final_m.worst));
        if lost {
            (LOST_AT, LOST_AT, true)
        } else {
            (mean, worst, false)
        }
    };
    let categories = names.iter().rev().map(|name| (*name).to_owned()).collect();
    let layout = layout(DISTANCES, names.len())
        .with_log_x()
        .with_x_tick_format(TickFormat::Custom(Arc::new(decade)))
        .with_y_categories(categories)
        .with_x_label("distance to the goal at the end [mm]; bars: worst seed; × lost")
        // The band that counts as settled.
        .with_reference_line(mark(50.0));
    let mut plots = grid(DISTANCES, &[0.1, 1.0, 10.0, 100.0], names.len());
    plots.extend(marks(rows, names, place));
    (plots, layout)
}

fn times(rows: &[StudyRow<'_>], names: &[&str]) -> Panel {
    let place = |outcome: &StudyOutcome| match outcome.settling_s {
        Some(time) => (time.mean, time.worst.min(NEVER_AT), false),
        None => (NEVER_AT, NEVER_AT, true),
    };
    let layout = layout(TIMES, names.len())
        .with_y_categories(vec![String::new(); names.len()])
        .with_x_tick_step(1.0)
        .with_x_label("settled within 5 cm, 0.05 rad [s]; × not before the hand-over")
        .with_legend_entries(legend())
        .with_legend_position(LegendPosition::OutsideRightTop);
    let mut plots = grid(TIMES, &[5.0, 6.0, 7.0, 8.0, 9.0], names.len());
    plots.extend(marks(rows, names, place));
    (plots, layout)
}

fn layout(x: (f64, f64), rows: usize) -> Layout {
    style::layout(x, height(rows))
}

fn height(rows: usize) -> (f64, f64) {
    (0.3, rows as f64 + 0.7)
}

/// A hair line between conditions, and at each number: categories leave no grid. Lines of data, for
/// reference lines are drawn over the marks.
fn grid(x: (f64, f64), numbers: &[f64], rows: usize) -> Vec<Plot> {
    let y = height(rows);
    let across = (1..rows).map(|row| row as f64 + 0.5);
    let across = across.map(|at| vec![(x.0, at), (x.1, at)]);
    let up = numbers.iter().map(|at| vec![(*at, y.0), (*at, y.1)]);
    let line = |points: Vec<(f64, f64)>| {
        let line = LinePlot::new().with_data(points).with_color("#e6e6e6");
        line.with_stroke_width(1.0).into()
    };
    across.chain(up).map(line).collect()
}

fn mark(x: f64) -> ReferenceLine {
    ReferenceLine::vertical(x)
        .with_color(GREY)
        .with_stroke_width(1.0)
        .with_label("5 cm")
}

/// A mark per law and case; `place` gives mean and worst, and whether the run failed.
fn marks(
    rows: &[StudyRow<'_>],
    names: &[&str],
    place: impl Fn(&StudyOutcome) -> (f64, f64, bool),
) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (law, color) in COLORS {
        for (case, shape) in SHAPES {
            for failed in [false, true] {
                let own = rows.iter().filter(|row| row.law == law && row.case == case);
                let (mut points, mut bars) = (Vec::new(), Vec::new());
                for row in own {
                    let (mean, worst, fails) = place(&row.outcome);
                    let name = row.condition.name.as_str();
                    let at = names.iter().position(|other| *other == name).unwrap_or(0);
                    if fails == failed {
                        points.push((mean, (names.len() - at) as f64 + lane(law, case)));
                        bars.push((0.0, worst - mean));
                    }
                }
                // A bar without length would leave its cap on the mark.
                let spread = points.iter().zip(&bars).filter(|(_, bar)| bar.1 > 0.0);
                let (ends, bars): (Vec<_>, Vec<_>) = spread.unzip();
                if !ends.is_empty() {
                    let ends = ends.into_iter().copied();
                    let bars = bars.into_iter().copied();
                    let plot = ScatterPlot::new()
                        .with_data(ends.collect::<Vec<_>>())
                        .with_x_err_asymmetric(bars)
                        .with_size(1.0)
                        .with_color(color);
                    plots.push(plot.into());
                }
                if points.is_empty() {
                    continue;
                }
                let shape = if failed { MarkerShape::Cross } else { shape };
                let plot = ScatterPlot::new()
                    .with_data(points)
                    .with_marker(shape)
                    .with_size(4.0)
                    .with_color(color);
                plots.push(plot.into());
            }
        }
    }
    plots
}

const COLORS: [(ComparedLaw, &str); 3] = [
    (ComparedLaw::Neural, BLUE.strong),
    (ComparedLaw::Plain, ORANGE.strong),
    (ComparedLaw::Default, GREEN.strong),
];

const SHAPES: [(Case, MarkerShape); 2] = [
    (Case::Line, MarkerShape::Circle),
    (Case::Curve, MarkerShape::Triangle),
];

/// Laws side by side within a row, and the cases of a law close to each other.
fn lane(law: ComparedLaw, case: Case) -> f64 {
    let lane = match law {
        ComparedLaw::Neural => 0.28,
        ComparedLaw::Plain => 0.0,
        ComparedLaw::Default => -0.28,
    };
    match case {
        Case::Line => lane + 0.05,
        Case::Curve => lane - 0.05,
    }
}

fn legend() -> Vec<kuva::plot::legend::LegendEntry> {
    let square = LegendShape::Marker(MarkerShape::Square);
    let laws = COLORS.map(|(law, color)| entry(law.name(), color, square, None));
    let cases =
        SHAPES.map(|(case, shape)| entry(case.name(), BLACK, LegendShape::Marker(shape), None));
    laws.into_iter().chain(cases).collect()
}

/// 0.01 to 1000 as they are.
fn decade(value: f64) -> String {
    format!("{value}")
}
