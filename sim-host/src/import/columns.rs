//! Whether the columns of a file hold what their names say: between versions of Choreo's schema some moved.
//!
//! Each column is compared with what it is the derivative or the cause of. The reference itself is
//! built from time and poses, so a shifted column costs nothing but a line in the verdict.

use super::raw::wrap;
use super::refusal::Place;
use super::repair::{Fix, Repairs};

/// Intervals shorter than this say nothing about rates, longer ones nothing about means \[s\].
const SHORT: f64 = 2e-3;
const LONG: f64 = 0.3;
/// A column may be off by this part of its largest value, plus `SLACK`, and still be believed.
const PART: f64 = 0.25;
const SLACK: f64 = 0.05;

/// The comparable columns.
pub(super) struct Columns {
    rows: Vec<Row>,
}

struct Row {
    place: Place,
    t: f64,
    x: f64,
    y: f64,
    heading: f64,
    vl: f64,
    vr: f64,
    omega: Option<f64>,
    al: Option<f64>,
    ar: Option<f64>,
    fl: Option<f64>,
    fr: Option<f64>,
}

/// What a format calls its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names {
    /// Wheel speeds.
    pub(super) speeds: &'static str,
    /// Turn rate.
    pub(super) omega: &'static str,
}

/// Columns that are not believed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contradictions {
    /// Wheel speeds.
    pub(super) speeds: bool,
    /// Turn rate.
    pub(super) omega: bool,
}

/// Place; t, x, y, heading; vl, vr, omega; al, ar, fl, fr.
type Values<'a> = (&'a Place, [f64; 4], [Option<f64>; 3], [Option<f64>; 4]);

impl Columns {
    /// Rows of a file; missing speeds count as 0 and are then found to contradict.
    pub(super) fn of<'a>(rows: impl Iterator<Item = Values<'a>>) -> Self {
        let rows = rows
            .map(|(place, pose, speeds, rest)| {
                let [t, x, y, heading] = pose;
                let [vl, vr, omega] = speeds;
                let [al, ar, fl, fr] = rest;
                Row {
                    place: place.clone(),
                    t,
                    x,
                    y,
                    heading,
                    vl: vl.unwrap_or(0.0),
                    vr: vr.unwrap_or(0.0),
                    omega,
                    al,
                    ar,
                    fl,
                    fr,
                }
            })
            .collect();
        Self { rows }
    }

    /// Whether every row has a turn rate.
    pub(super) fn has_turn_rate(&self) -> bool {
        self.rows.iter().all(|r| r.omega.is_some())
    }

    /// The worst row of a column: pairs (stated, derived) over intervals, compared as means.
    fn worst(&self, pair: impl Fn(&Row, &Row, f64) -> Option<(f64, f64)>) -> Option<(usize, f64)> {
        let mut scale: f64 = 0.0;
        let mut worst = (0, 0.0);
        for (i, ends) in self.rows.windows(2).enumerate() {
            let [from, to] = ends else { continue };
            let dt = to.t - from.t;
            if !(SHORT..LONG).contains(&dt) {
                continue;
            }
            let Some((stated, derived)) = pair(from, to, dt) else {
                continue;
            };
            scale = scale.max(derived.abs());
            if (stated - derived).abs() > worst.1 {
                worst = (i, (stated - derived).abs());
            }
        }
        (worst.1 > SLACK + PART * scale).then_some(worst)
    }
}

/// Compares the columns and lists what contradicts.
pub(super) fn contradictions(
    columns: &Columns,
    names: Names,
    repairs: &mut Repairs,
) -> Contradictions {
    let mut add = |found: Option<(usize, f64)>, column, with| {
        let Some((row, by)) = found else { return false };
        if let Some(row) = columns.rows.get(row) {
            let what = Fix::ColumnContradicts { column, with, by };
            repairs.add(row.place.clone().field(column), row.t, what);
        }
        true
    };
    let speeds = columns.worst(|a, b, dt| {
        let mean = 0.25 * (a.vl + a.vr + b.vl + b.vr);
        let heading = a.heading + 0.5 * wrap(b.heading - a.heading);
        let along = (b.x - a.x) * libm::cos(heading) + (b.y - a.y) * libm::sin(heading);
        Some((mean, along / dt))
    });
    let omega = columns.worst(|a, b, dt| {
        let mean = 0.5 * (a.omega? + b.omega?);
        let expected = mean * dt;
        let turn = expected + wrap(b.heading - a.heading - expected);
        Some((mean, turn / dt))
    });
    let left = columns.worst(|a, b, dt| Some((a.al?, (b.vl - a.vl) / dt)));
    let right = columns.worst(|a, b, dt| Some((a.ar?, (b.vr - a.vr) / dt)));
    // Newton: the forces add up to mass times mean acceleration, with one mass for all rows.
    let sums = |r: &Row| Some((r.fl? + r.fr?, 0.5 * (r.al? + r.ar?)));
    let (mut fa, mut aa) = (0.0, 0.0);
    for (force, a) in columns.rows.iter().filter_map(sums) {
        fa += force * a;
        aa += a * a;
    }
    let mass = if aa > 0.0 { fa / aa } else { 0.0 };
    let forces = columns.worst(|a, _, _| {
        let (force, accel) = sums(a)?;
        (mass > 0.0).then_some((force / mass, accel))
    });
    let found = Contradictions {
        speeds: add(speeds, names.speeds, "the poses"),
        omega: add(omega, names.omega, "the headings"),
    };
    add(left, "al", "the rate of vl");
    add(right, "ar", "the rate of vr");
    let negative = (aa > 0.0 && mass <= 0.0 && fa != 0.0).then_some((0, fa.abs()));
    add(forces.or(negative), "fl, fr", "al, ar");
    found
}
