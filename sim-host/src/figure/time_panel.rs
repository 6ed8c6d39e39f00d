//! A panel with time to the right.

use super::axis::Axis;
use super::chart::{Chart, Item, Place};
use super::corner::Corner;
use super::drawing::Stroke;
use super::legend::{Entry, entry};
use super::limits::Span;
use super::notes::Canvas;
use super::style::{self, Ink, stroke};
use super::thin_out::thin_out;
use super::{Labelled, last_parking, stop_name};
use crate::trace::{Trace, TraceRow};
use controller_core::motion::Mode;

/// What a curve shows.
#[derive(Clone, Copy)]
pub(super) struct Signal {
    pub name: &'static str,
    pub ink: Ink,
    pub value: fn(&TraceRow) -> f64,
    pub dashed: bool,
    /// The signal is 0 before the first row, and its first step is part of the picture.
    pub from_zero: bool,
    /// There is one only while the robot is driven by velocity.
    pub ordered: bool,
}

impl Signal {
    const fn dashes(&self) -> &'static [f32] {
        if self.dashed { DASHES } else { &[] }
    }

    /// Whether the signal is there in a row.
    fn is_in(&self, row: &TraceRow) -> bool {
        !self.ordered || row.report.mode == Mode::Driving
    }

    /// The rows in which it is there.
    fn rows<'a>(&self, trace: &'a Trace) -> impl Iterator<Item = &'a TraceRow> {
        let signal = *self;
        trace.rows.iter().filter(move |row| signal.is_in(row))
    }
}

/// What a panel shows.
pub(super) struct TimePanel<'a> {
    pub title: &'static str,
    pub y_label: &'static str,
    /// Width and height of the panel \[px\].
    pub size: (f64, f64),
    pub signals: &'a [Signal],
}

/// Largest deviation of a drawn curve from the trace \[px\].
const TOLERANCE: f64 = 0.15;
const DASHES: &[f32] = &[7.0, 4.0];
/// What is shown of the time before the start, as a share of the run.
const LEAD: f64 = 0.012;

impl TimePanel<'_> {
    /// The curves of `main` over those of `other`.
    pub fn draw(&self, main: Labelled<'_>, other: Option<Labelled<'_>>) -> Chart {
        let entries = self.legend(main, other);
        let canvas = self.canvas(main, other, &entries);
        let (x, y) = (canvas.x, canvas.y);
        let scale = (self.size.0 / (x.1 - x.0), self.size.1 / (y.1 - y.0));
        let curves = |run: Labelled<'_>, strong: bool| -> Vec<Item> {
            let signals = self.signals.iter();
            signals
                .flat_map(|s| curves_of(s, run.trace, scale, strong))
                .collect()
        };
        let mut items = other.map_or_else(Vec::new, |other| curves(other, false));
        items.extend(curves(main, true));
        let mut chart = Chart {
            title: self.title.to_owned(),
            legend: entries,
            place: Place::Inside(canvas.legend),
            ..Chart::new(Axis::new(x, "t [s]"), Axis::new(y, self.y_label), items)
        };
        canvas.mark(&mut chart);
        if let Some((text, above)) = other.and_then(|other| self.off_scale(other, y)) {
            canvas.remark(&mut chart, text, above);
        }
        chart
    }

    /// Axis limits that show `main` well, and a place for the legend.
    fn canvas(&self, main: Labelled<'_>, other: Option<Labelled<'_>>, entries: &[Entry]) -> Canvas {
        let runs = [Some(main), other];
        let rows = || runs.iter().flatten().flat_map(|run| &run.trace.rows);
        let t_end = rows().map(|row| row.t).fold(0.0, f64::max);
        // Room for the step at the start, which would else hide behind the axis.
        let steps = self.signals.iter().any(|signal| signal.from_zero);
        let x = (if steps { -LEAD * t_end } else { 0.0 }, t_end);
        let mut span = self.span(main.trace);
        if let Some(other) = other {
            span = span.stretched(self.span(other.trace));
        }
        let mut y = span.padded();
        let there = |row| self.signals.iter().filter(move |signal| signal.is_in(row));
        let points = rows().flat_map(|row| there(row).map(|s| (row.t, (s.value)(row))));
        let (width, height) = (
            self.size.0 - style::MARGINS.0,
            self.size.1 - style::MARGINS.1,
        );
        let (mut legend, hidden) = Corner::emptiest(points, (x, y), entries, (width, height));
        if hidden > 0 {
            legend = Corner::TOP_RIGHT;
            y.1 = Corner::room_above(y, entries, height);
        }
        let parking = last_parking(main.trace);
        let stop = main.trace.stop();
        Canvas {
            x,
            y,
            width,
            legend,
            legend_size: Corner::legend_share(entries, (width, height)),
            parking: parking.map(|(row, name)| (main.trace.rows[row].t, name)),
            stop: stop.map(|row| (row.t, stop_name(row))),
        }
    }

    fn span(&self, trace: &Trace) -> Span {
        let spans = self.drawn(trace).map(|s| span_of(s, trace));
        spans.reduce(Span::with).unwrap_or(Span {
            low: 0.0,
            high: 0.0,
        })
    }

    /// The signals that a run has.
    fn drawn(&self, trace: &Trace) -> impl Iterator<Item = &Signal> {
        let signals = self.signals.iter();
        signals.filter(|signal| signal.rows(trace).next().is_some())
    }

    fn legend(&self, main: Labelled<'_>, other: Option<Labelled<'_>>) -> Vec<Entry> {
        let mut entries = Vec::new();
        for s in self.drawn(main.trace) {
            entries.push(entry(
                &self.label(s, main, other.is_some()),
                s.ink.strong,
                None,
                s.dashes(),
            ));
        }
        if let Some(other) = other {
            for s in self.drawn(other.trace) {
                entries.push(entry(
                    &self.label(s, other, true),
                    s.ink.pale,
                    None,
                    s.dashes(),
                ));
            }
        }
        entries
    }

    fn label(&self, signal: &Signal, run: Labelled<'_>, name_run: bool) -> String {
        if name_run {
            format!("{}, {}", signal.name, run.label)
        } else {
            signal.name.to_owned()
        }
    }

    /// What of `other` lies outside the axis, in words, and whether it is above only.
    fn off_scale(&self, other: Labelled<'_>, y: (f64, f64)) -> Option<(String, bool)> {
        let outside: Vec<String> = self
            .drawn(other.trace)
            .filter_map(|signal| {
                let span = span_of(signal, other.trace);
                let low = (span.low < y.0).then_some(span.low);
                let high = (span.high > y.1).then_some(span.high);
                let values: Vec<_> = [low, high].into_iter().flatten().map(short).collect();
                let name = signal.name;
                (!values.is_empty()).then(|| format!("{name} to {}", values.join(" and ")))
            })
            .collect();
        let below = self.span(other.trace).low < y.0;
        let text = format!("{}, off the scale: {}", other.label, outside.join(", "));
        (!outside.is_empty()).then_some((text, !below))
    }
}

fn span_of(signal: &Signal, trace: &Trace) -> Span {
    let before = signal.from_zero.then_some(0.0);
    Span::of(signal.rows(trace).map(signal.value).chain(before))
}

/// A curve for each stretch in which the signal is there.
fn curves_of(signal: &Signal, trace: &Trace, scale: (f64, f64), main: bool) -> Vec<Item> {
    let t_end = trace.rows.last().map_or(0.0, |row| row.t);
    let rest = [(-LEAD * t_end, 0.0), (0.0, 0.0)];
    let before: &[_] = if signal.from_zero { &rest } else { &[] };
    let ink = signal.ink;
    let stroke = Stroke {
        color: if main { ink.strong } else { ink.pale },
        width: stroke(main),
        dashes: signal.dashes(),
    };
    let stretches = trace
        .rows
        .chunk_by(|a, b| signal.is_in(a) == signal.is_in(b));
    let there = stretches.filter(|rows| signal.is_in(&rows[0]));
    there
        .map(|rows| {
            let rows = rows.iter().map(|row| (row.t, (signal.value)(row)));
            let points: Vec<_> = before.iter().copied().chain(rows).collect();
            Item::Line(thin_out(&points, scale, TOLERANCE), stroke)
        })
        .collect()
}

/// Three digits are plenty in a picture.
fn short(value: f64) -> String {
    let text = if value.abs() >= 100.0 {
        format!("{value:.0}")
    } else if value.abs() >= 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.2}")
    };
    text.replace('-', "−")
}
