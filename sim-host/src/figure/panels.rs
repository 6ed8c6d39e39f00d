//! The five panels.

use super::axis::Axis;
use super::chart::{Chart, Item, Place};
use super::corner::Corner;
use super::drawing::{Color, Stroke};
use super::legend::{Marker, entry};
use super::limits::Span;
use super::style::{self, BLACK, BLUE, GREEN, GREY, Ink, ORANGE, STRONG};
use super::thin_out::thin_out;
use super::time_panel::{Signal, TimePanel};
use super::{Labelled, last_parking, stop_name};
use crate::trace::{Trace, TraceRow};
use controller_core::motion::Mode;

/// Of the reference.
const DASHES: &[f32] = &[6.0, 4.0];

/// (a): the plane, both axes to one scale.
pub(super) fn trajectories(main: Labelled<'_>, other: Option<Labelled<'_>>) -> Chart {
    let rows = &main.trace.rows;
    let references = references(main.trace);
    let mut marks = vec![("start", Marker::Circle, point(&rows[0]))];
    if let Some((row, name)) = last_parking(main.trace) {
        marks.push((name, Marker::Diamond, point(&rows[row])));
    }
    if let Some(aim) = main.trace.aim() {
        marks.push(("target", Marker::Star, reference_point(aim)));
    }
    let stop = main.trace.stop();
    let stopped = stop.map_or_else(String::new, stop_name);
    if let Some(last) = rows.last().filter(|_| stop.is_some()) {
        marks.push((&stopped, Marker::Cross, point(last)));
    }
    let path: Vec<_> = rows.iter().map(point).collect();
    let below: Vec<_> = other.map_or_else(Vec::new, |o| o.trace.rows.iter().map(point).collect());
    let marked = marks.iter().map(|(_, _, point)| *point);
    let reference = || references.iter().flatten();
    let all = || reference().chain(&path).copied().chain(marked.clone());
    let span = |pick: fn((f64, f64)) -> f64| {
        let stretch = Span::of(below.iter().copied().map(pick));
        let own = Span::of(all().map(pick));
        if below.is_empty() {
            own
        } else {
            own.stretched(stretch)
        }
    };
    let plot = (
        style::CELL.0 - style::MARGINS.0,
        style::FIRST_ROW - style::MARGINS.1,
    );
    let (x, y) = equal_aspect(span(|p| p.0).padded(), span(|p| p.1).padded(), plot);
    let pixels = plot.0 / (x.1 - x.0);
    let line = |points: &[(f64, f64)], color: Color, width, dashes| {
        let stroke = Stroke {
            color,
            width,
            dashes,
        };
        Item::Line(thin_out(points, (pixels, pixels), 0.15), stroke)
    };
    let mut items = Vec::new();
    let mut entries = vec![entry(main.label, BLUE.strong, None, &[])];
    // One that stands is no line.
    let mut pairs = references.iter().flat_map(|points| points.windows(2));
    if pairs.any(|pair| pair[0] != pair[1]) {
        entries.insert(0, entry("reference", GREY, None, DASHES));
    }
    if let Some(other) = other {
        items.push(line(&below, BLUE.pale, 1.6, &[]));
        entries.push(entry(other.label, BLUE.pale, None, &[]));
    }
    for points in &references {
        items.push(line(points, GREY, 1.6, DASHES));
    }
    items.push(line(&path, BLUE.strong, STRONG, &[]));
    for (name, marker, point) in marks {
        let color = if name == "target" {
            ORANGE.strong
        } else {
            BLACK
        };
        items.push(Item::Mark(point, marker, 6.0, color));
        entries.push(entry(name, color, Some(marker), &[]));
    }
    let seen = reference().chain(&path).chain(&below).copied();
    let (corner, _) = Corner::emptiest(seen, (x, y), &entries, plot);
    Chart {
        title: "Reference and real trajectories".to_owned(),
        equal: true,
        legend: entries,
        place: Place::Inside(corner),
        ..Chart::new(Axis::new(x, "x [m]"), Axis::new(y, "y [m]"), items)
    }
}

/// Where the reference was while the robot followed it, stretch by stretch. Who parks, or drives by velocity, has no reference
/// that moves.
fn references(trace: &Trace) -> Vec<Vec<(f64, f64)>> {
    let mut all = Vec::new();
    let mut end = 0;
    for rows in trace.rows.chunk_by(|a, b| follows(a) == follows(b)) {
        end += rows.len();
        if !follows(&rows[0]) {
            continue;
        }
        let mut points: Vec<_> = rows.iter().map(reference_point).collect();
        if let Some(hand_over) = trace.hand_over.filter(|hand_over| hand_over.row == end) {
            let pose = hand_over.left.pose();
            points.push((pose.x, pose.y));
        }
        all.push(points);
    }
    all
}

fn follows(row: &TraceRow) -> bool {
    row.report.mode == Mode::Following
}

/// Both ranges, one of them widened, so that a metre is as long across as up.
fn equal_aspect(x: (f64, f64), y: (f64, f64), plot: (f64, f64)) -> ((f64, f64), (f64, f64)) {
    let metre = ((x.1 - x.0) / plot.0).max((y.1 - y.0) / plot.1);
    let widened = |range: (f64, f64), pixels: f64| {
        let (middle, half) = (0.5 * (range.0 + range.1), 0.5 * metre * pixels);
        (middle - half, middle + half)
    };
    (widened(x, plot.0), widened(y, plot.1))
}

fn point(row: &TraceRow) -> (f64, f64) {
    (row.truth.pose.x, row.truth.pose.y)
}

fn reference_point(row: &TraceRow) -> (f64, f64) {
    (row.reference.pose().x, row.reference.pose().y)
}

/// (b).
pub(super) fn errors(main: Labelled<'_>, other: Option<Labelled<'_>>) -> Chart {
    TimePanel {
        title: "Posture errors",
        y_label: "e_x, e_y [m], e_θ [rad]",
        size: (style::CELL.0, style::FIRST_ROW),
        signals: &[
            signal("e_x", BLUE, |row| row.error.x),
            signal("e_y", ORANGE, |row| row.error.y),
            signal("e_θ", GREEN, |row| row.error.theta),
        ],
    }
    .draw(main, other)
}

/// (c).
pub(super) fn linear_velocity(main: Labelled<'_>, other: Option<Labelled<'_>>) -> Chart {
    TimePanel {
        title: "Actual and desired linear velocities",
        y_label: "v, v_c [m/s]",
        size: style::CELL,
        signals: &[
            order("ordered v", |row| row.reference.twist().linear),
            signal("actual v", BLUE, |row| row.truth.twist.linear),
            Signal {
                dashed: true,
                ..signal("desired v_c", ORANGE, |row| row.report.command.linear)
            },
        ],
    }
    .draw(main, other)
}

/// (d).
pub(super) fn angular_velocity(main: Labelled<'_>, other: Option<Labelled<'_>>) -> Chart {
    TimePanel {
        title: "Actual and desired angular velocities",
        y_label: "w, w_c [rad/s]",
        size: style::CELL,
        signals: &[
            order("ordered w", |row| row.reference.twist().angular),
            signal("actual w", BLUE, |row| row.truth.twist.angular),
            Signal {
                dashed: true,
                ..signal("desired w_c", ORANGE, |row| row.report.command.angular)
            },
        ],
    }
    .draw(main, other)
}

/// (e).
pub(super) fn torques(main: Labelled<'_>, other: Option<Labelled<'_>>) -> Chart {
    TimePanel {
        title: "Force and moment",
        y_label: "τ_1 [N], τ_2 [N m]",
        size: (2.0 * style::CELL.0 + style::SPACING, style::CELL.1),
        signals: &[
            Signal {
                from_zero: true,
                ..signal("force τ_1", BLUE, |row| row.report.wrench.force)
            },
            Signal {
                from_zero: true,
                ..signal("moment τ_2", ORANGE, |row| row.report.wrench.moment)
            },
        ],
    }
    .draw(main, other)
}

fn signal(name: &'static str, ink: Ink, value: fn(&TraceRow) -> f64) -> Signal {
    Signal {
        name,
        ink,
        value,
        dashed: false,
        from_zero: false,
        ordered: false,
    }
}

/// Of a robot that is driven by velocity.
fn order(name: &'static str, value: fn(&TraceRow) -> f64) -> Signal {
    Signal {
        dashed: true,
        ordered: true,
        ..signal(name, style::ORDER, value)
    }
}
