//! Whether the columns of a file hold what their names say: between versions of Choreo's schema some moved, and tables are of
//! anybody's making.
//!
//! Each column is compared with what it is the derivative or the cause of. The reference itself is
//! built from time and poses, so a shifted column costs nothing but a line in the verdict.

use super::noise::Noise;
use super::raw::{RawSample, wrap};
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
    /// By how far two poses may lie apart by noise: ahead \[m\], and in heading \[rad\].
    noise: [f64; 2],
}

struct Row {
    place: Place,
    t: f64,
    x: f64,
    y: f64,
    heading: f64,
    vl: Option<f64>,
    vr: Option<f64>,
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
                    vl: vl.or(Some(0.0)),
                    vr: vr.or(Some(0.0)),
                    omega,
                    al,
                    ar,
                    fl,
                    fr,
                }
            })
            .collect();
        Self {
            rows,
            noise: [0.0; 2],
        }
    }

    /// Rows of a table, whose poses may be recorded. What it does not state contradicts nothing.
    fn of_samples(samples: &[RawSample]) -> Self {
        let rows = samples.iter().map(|sample| Row {
            place: sample.place.clone(),
            t: sample.t,
            x: sample.x,
            y: sample.y,
            heading: sample.theta,
            vl: sample.v,
            vr: sample.v,
            omega: sample.w,
            al: None,
            ar: None,
            fl: None,
            fr: None,
        });
        Self {
            rows: rows.collect(),
            // Each of the two poses may be off.
            noise: Noise::of(samples).expected().map(|off| 2.0 * off),
        }
    }

    /// Whether every row has a turn rate.
    pub(super) fn has_turn_rate(&self) -> bool {
        self.rows.iter().all(|r| r.omega.is_some())
    }

    /// The worst row of a column: pairs (stated, derived) over intervals, compared as means. `noise` is that of what is derived,
    /// over an interval.
    fn worst(
        &self,
        noise: f64,
        pair: impl Fn(&Row, &Row, f64) -> Option<(f64, f64)>,
    ) -> Option<(usize, f64)> {
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
            let by = (stated - derived).abs() - noise / dt;
            if by > worst.1 {
                worst = (i, by);
            }
        }
        (worst.1 > SLACK + PART * scale).then_some(worst)
    }
}

/// Takes speeds and turn rates from samples whose poses contradict them, and lists that.
pub(super) fn believe(samples: &mut [RawSample], names: Names, repairs: &mut Repairs) {
    let bad = contradictions(&Columns::of_samples(samples), names, repairs);
    for sample in samples {
        sample.v = sample.v.filter(|_| !bad.speeds);
        sample.w = sample.w.filter(|_| !bad.omega);
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
    let [ahead, turned] = columns.noise;
    let speeds = columns.worst(ahead, |a, b, dt| {
        let mean = 0.25 * (a.vl? + a.vr? + b.vl? + b.vr?);
        let heading = a.heading + 0.5 * wrap(b.heading - a.heading);
        let along = (b.x - a.x) * libm::cos(heading) + (b.y - a.y) * libm::sin(heading);
        Some((mean, along / dt))
    });
    let omega = columns.worst(turned, |a, b, dt| {
        let mean = 0.5 * (a.omega? + b.omega?);
        let expected = mean * dt;
        let turn = expected + wrap(b.heading - a.heading - expected);
        Some((mean, turn / dt))
    });
    let left = columns.worst(0.0, |a, b, dt| Some((a.al?, (b.vl? - a.vl?) / dt)));
    let right = columns.worst(0.0, |a, b, dt| Some((a.ar?, (b.vr? - a.vr?) / dt)));
    // Newton: the forces add up to mass times mean acceleration, with one mass for all rows.
    let sums = |r: &Row| Some((r.fl? + r.fr?, 0.5 * (r.al? + r.ar?)));
    let (mut fa, mut aa) = (0.0, 0.0);
    for (force, a) in columns.rows.iter().filter_map(sums) {
        fa += force * a;
        aa += a * a;
    }
    let mass = if aa > 0.0 { fa / aa } else { 0.0 };
    let forces = columns.worst(0.0, |a, _, _| {
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
