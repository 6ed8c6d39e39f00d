//! The benchmark: time beside exactness, a panel for each base, and the front of both.

use super::FigureError;
use super::axis::Axis;
use super::chart::{Chart, Item, sheet};
use super::drawing::{Color, Drawing, Stroke};
use super::legend::{Entry, Marker, entry};
use crate::bench::{Class, LawKind, Row, Summary, better};

/// Width of a panel, of one with the legend beside it, and height of all \[px\].
const WIDTHS: (f64, f64) = (470.0, 740.0);
const HEIGHT: f64 = 430.0;
/// Where a law that never arrives is drawn, beyond the slowest that does.
const NEVER: f64 = 1.6;
/// Of the line along the front.
const FRONT: Color = "#bbbbbb";
/// Finer than this nothing differs \[mm, or mm/s\].
const FINEST: f64 = 0.01;

/// Colour and mark of a law.
const fn look(kind: LawKind) -> (Color, Marker) {
    use Marker as M;
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

/// The Pareto figure of a class.
///
/// # Errors
/// [`FigureError::Empty`] if no law ran.
pub fn pareto(rows: &[Row], class: Class, bases: &[String]) -> Result<Drawing, FigureError> {
    let rows = better(rows, class);
    let count = rows.first().map_or(0, |row| row.bases.len());
    if count == 0 {
        return Err(FigureError::Empty);
    }
    let cells = (0..count).map(|at| {
        let width = if at + 1 == count { WIDTHS.1 } else { WIDTHS.0 };
        (width, None, panel(&rows, at, count, bases))
    });
    Ok(sheet(&class.name(), vec![(HEIGHT, cells.collect())]))
}

fn panel(rows: &[&Row], at: usize, count: usize, bases: &[String]) -> Chart {
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
    let mut front: Vec<(f64, f64)> = own
        .iter()
        .filter(|summary| summary.on_front)
        .map(|summary| place(summary))
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let stroke = Stroke {
        color: FRONT,
        width: 1.5,
        dashes: &[],
    };
    let mut items = vec![Item::Line(front, stroke)];
    for summary in &own {
        let (time, off) = place(summary);
        let (color, marker) = look(summary.law.kind);
        let marker = if summary.ratio.median.is_finite() {
            marker
        } else {
            Marker::Cross
        };
        let size = if summary.law.kind == LawKind::Default {
            7.0
        } else {
            5.0
        };
        items.push(Item::Mark((time, off.min(high)), marker, size, color));
    }
    let title = bases.get(own.first().map_or(at, |summary| summary.base));
    let y_label = if at == 0 { y_label(&own) } else { "" };
    let x = Axis::log(x, "time : least time, median; × never");
    Chart {
        title: title.cloned().unwrap_or_default(),
        legend: if at + 1 == count {
            legend(rows)
        } else {
            Vec::new()
        },
        ..Chart::new(x, Axis::log((low, high), y_label), items)
    }
}

fn y_label(own: &[&Summary]) -> &'static str {
    use crate::bench::Track;
    match own.first().map(|summary| summary.class.track) {
        Some(Track::Parking) => "distance at the end [mm], median",
        Some(Track::Velocity) => "rim beside its order, RMS [mm/s]",
        _ => "off the reference, RMS [mm]",
    }
}

fn legend(rows: &[&Row]) -> Vec<Entry> {
    let law = |row: &&Row| {
        let (color, marker) = look(row.law.kind);
        entry(&crate::bench::label(row), color, Some(marker), &[])
    };
    let front = entry("front", FRONT, None, &[]);
    rows.iter().map(law).chain([front]).collect()
}
