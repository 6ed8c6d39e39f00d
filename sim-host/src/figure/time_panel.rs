//! A panel with time to the right.

use super::Labelled;
use super::corner::Corner;
use super::limits::Span;
use super::notes::Canvas;
use super::style::{self, Ink, Panel, entry, stroke};
use super::thin_out::thin_out;
use crate::trace::{Trace, TraceRow};
use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::{LinePlot, LineStyle};
use kuva::render::plots::Plot;

/// What a curve shows.
#[derive(Clone, Copy)]
pub(super) struct Signal {
    pub name: &'static str,
    pub ink: Ink,
    pub value: fn(&TraceRow) -> f64,
    pub dashed: bool,
    /// The signal is 0 before the first row, and its first step is part of the picture.
    pub from_zero: bool,
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
const DASHES: &str = "7 4";
/// What is shown of the time before the start, as a share of the run.
const LEAD: f64 = 0.012;

impl TimePanel<'_> {
    /// The curves of `main` over those of `other`.
    pub fn draw(&self, main: Labelled<'_>, other: Option<Labelled<'_>>) -> Panel {
        let entries = self.legend(main, other);
        let canvas = self.canvas(main, other, &entries);
        let (x, y) = (canvas.x, canvas.y);
        let scale = (self.size.0 / (x.1 - x.0), self.size.1 / (y.1 - y.0));
        let curves = |run: Labelled<'_>, strong: bool| -> Vec<Plot> {
            let signals = self.signals.iter();
            signals
                .map(|s| curve(s, run.trace, scale, strong))
                .collect()
        };
        let mut plots = other.map_or_else(Vec::new, |other| curves(other, false));
        plots.extend(curves(main, true));
        let layout = style::layout(x, y)
            .with_title(self.title)
            .with_x_label("t [s]")
            .with_y_label(self.y_label)
            .with_legend_entries(entries)
            .with_legend_position(canvas.legend.position());
        let layout = canvas.mark_hand_over(layout);
        match other.and_then(|other| self.off_scale(other, y)) {
            Some((text, above)) => (plots, canvas.remark(layout, text, above)),
            None => (plots, layout),
        }
    }

    /// Axis limits that show `main` well, and a place for the legend.
    fn canvas(
        &self,
        main: Labelled<'_>,
        other: Option<Labelled<'_>>,
        entries: &[LegendEntry],
    ) -> Canvas {
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
        let points = rows().flat_map(|row| self.signals.iter().map(|s| (row.t, (s.value)(row))));
        let (width, height) = (
            self.size.0 - style::MARGINS.0,
            self.size.1 - style::MARGINS.1,
        );
        let (mut legend, hidden) = Corner::emptiest(points, (x, y), entries, (width, height));
        if hidden > 0 {
            legend = Corner::TOP_RIGHT;
            y.1 = Corner::room_above(y, entries, height);
        }
        let hand_over = main.trace.parking();
        Canvas {
            x,
            y,
            width,
            legend,
            legend_size: Corner::legend_share(entries, (width, height)),
            hand_over: hand_over.map(|hand_over| main.trace.rows[hand_over.row].t),
        }
    }

    fn span(&self, trace: &Trace) -> Span {
        let spans = self.signals.iter().map(|s| span_of(s, trace));
        spans.reduce(Span::with).unwrap_or(Span {
            low: 0.0,
            high: 0.0,
        })
    }

    fn legend(&self, main: Labelled<'_>, other: Option<Labelled<'_>>) -> Vec<LegendEntry> {
        let dashes = |s: &Signal| s.dashed.then_some(DASHES);
        let mut entries = Vec::new();
        let line = LegendShape::Line;
        for s in self.signals {
            entries.push(entry(
                &self.label(s, main, other.is_some()),
                s.ink.strong,
                line,
                dashes(s),
            ));
        }
        if let Some(other) = other {
            for s in self.signals {
                entries.push(entry(
                    &self.label(s, other, true),
                    s.ink.pale,
                    line,
                    dashes(s),
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
            .signals
            .iter()
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
    Span::of(trace.rows.iter().map(signal.value).chain(before))
}

fn curve(signal: &Signal, trace: &Trace, scale: (f64, f64), main: bool) -> Plot {
    let t_end = trace.rows.last().map_or(0.0, |row| row.t);
    let rest = [(-LEAD * t_end, 0.0), (0.0, 0.0)];
    let before: &[_] = if signal.from_zero { &rest } else { &[] };
    let rows = trace.rows.iter().map(|row| (row.t, (signal.value)(row)));
    let points: Vec<_> = before.iter().copied().chain(rows).collect();
    let ink = signal.ink;
    let mut line = LinePlot::new()
        .with_data(thin_out(&points, scale, TOLERANCE))
        .with_color(if main { ink.strong } else { ink.pale })
        .with_stroke_width(stroke(main));
    if signal.dashed {
        line = line.with_line_style(LineStyle::Custom(DASHES.into()));
    }
    line.into()
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
