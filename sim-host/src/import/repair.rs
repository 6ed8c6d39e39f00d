//! What had to be repaired, and where.

use super::{Closeness, Place};
use std::fmt;

/// One repair, or a run of like repairs at consecutive samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Repair {
    /// The first sample concerned.
    pub place: Place,
    /// Its time in the file \[s\], from that of the first sample on.
    pub t: f64,
    /// How many samples in all.
    pub count: usize,
    /// What was done.
    pub what: Fix,
}

/// What was done to a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Fix {
    /// The same instant again, with the same pose.
    DroppedRepeat,
    /// Closer in time than 1 ms: one knot for all, every pose still compared.
    SharedKnot,
    /// Curvature without meaning, as at standstill: the turn rate comes from the headings.
    CurvatureIgnored(f64),
    /// A velocity, turn rate, acceleration or force that is null or not finite.
    ValueIgnored,
    /// A column contradicts the poses or speeds, as after a shift of columns: it is not used.
    ColumnContradicts {
        /// Its name.
        column: &'static str,
        /// What it was compared with.
        with: &'static str,
        /// Largest difference.
        by: f64,
    },
    /// A column is missing and was derived.
    ColumnDerived {
        /// Its name.
        column: &'static str,
        /// From what.
        from: &'static str,
    },
    /// The speeds of the two samples, held over the gap, cannot be what the base did: smoothed.
    Smoothed {
        /// Angular acceleration that the file implies \[rad/s²\].
        implied: f64,
        /// What the reference has there \[rad/s²\].
        now: f64,
    },
    /// Poses have more noise than the reference's tolerance, along an axis and in heading: it passes them farther off, farthest here.
    Noise {
        /// Standard deviation of the noise.
        scatter: Closeness,
        /// How far off they are passed.
        off: Closeness,
    },
    /// The file moves at this end and states no speeds: run from rest to rest.
    AtRest {
        /// How fast it moves there by its poses \[m/s\].
        speed: f64,
        /// And turns \[rad/s\].
        turn_rate: f64,
    },
    /// More repairs than are listed.
    More,
}

impl fmt::Display for Fix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DroppedRepeat => f.write_str("repeated instant dropped"),
            Self::SharedKnot => f.write_str("samples less than 1 ms apart joined"),
            Self::CurvatureIgnored(k) => {
                write!(
                    f,
                    "curvature {k:.3e} 1/m means nothing here; turn rate from the headings"
                )
            }
            Self::ValueIgnored => f.write_str("null or infinite value not used"),
            Self::ColumnContradicts { column, with, by } => {
                write!(
                    f,
                    "column `{column}` contradicts {with} by up to {by:.3}; not used"
                )
            }
            Self::ColumnDerived { column, from } => {
                write!(f, "column `{column}` is missing; derived from {from}")
            }
            Self::Smoothed { implied, now } => write!(
                f,
                "implied angular acceleration {implied:.0} rad/s² smoothed to {now:.1} rad/s²"
            ),
            Self::Noise { scatter, off } => write!(
                f,
                "noise of the poses, {scatter} (standard deviation), smoothed: they are passed up to {off} off, farthest here"
            ),
            Self::AtRest { speed, turn_rate } => write!(
                f,
                "moves here at {speed:.2} m/s and {turn_rate:.2} rad/s, and states no speeds: run from rest to rest"
            ),
            Self::More => f.write_str("further repairs not listed"),
        }
    }
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (t = {:.4} s)", self.place, self.t)?;
        if self.count > 1 {
            write!(f, " and {} more", self.count - 1)?;
        }
        write!(f, ": {}", self.what)
    }
}

/// Most repairs that are listed; runs of the same kind count once.
const LISTED: usize = 200;

/// Collects repairs; consecutive ones of a kind become one entry.
#[derive(Clone, Debug, Default)]
pub(super) struct Repairs {
    list: Vec<Repair>,
    /// Index of the sample that the last entry reaches to.
    last: usize,
}

impl Repairs {
    /// Adds a repair of one sample.
    pub(super) fn add(&mut self, place: Place, t: f64, what: Fix) {
        let index = place.sample.unwrap_or(0);
        if let Some(entry) = self.list.last_mut() {
            let same = std::mem::discriminant(&entry.what) == std::mem::discriminant(&what);
            let whole_column = matches!(
                what,
                Fix::ColumnContradicts { .. } | Fix::ColumnDerived { .. }
            );
            let adjacent = index <= self.last + 1 && !whole_column;
            if (same && adjacent) || entry.what == Fix::More {
                entry.count += 1;
                self.last = index;
                return;
            }
        }
        let what = if self.list.len() == LISTED {
            Fix::More
        } else {
            what
        };
        self.last = index;
        self.list.push(Repair {
            place,
            t,
            count: 1,
            what,
        });
    }

    /// The list; times are shifted to start at 0.
    pub(super) fn finish(mut self, start: f64) -> Vec<Repair> {
        for repair in &mut self.list {
            repair.t -= start;
        }
        self.list
    }
}
