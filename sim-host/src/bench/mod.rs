//! The benchmark: the default law beside published ones, on the same wheels, limits, velocity loop, estimator and plant.
//!
//! A [`Class`] is a track on a plant. Every [`Law`] runs the same cases of it: the paper's two, parking from starts whose
//! least time is known ([`minimum`]), trajectory files, steps of velocity orders; on the ideal plant, on the base's own
//! hardware with ±30 % of mass and inertia, and on the bad floor of [`crate::trials`]. Rivals have their usual constants and
//! those that a search finds with the budget and the score of [`crate::tune`]. Everything follows from a seed; nothing
//! depends on the number of threads.

mod chip;
mod csv;
mod figures;
#[cfg(feature = "figures")]
mod html;
mod law;
pub mod minimum;
mod study;
mod summary;
mod table;
mod tracks;
mod tuned;
mod tuning;

pub use chip::instructions;
pub use csv::write as write_csv;
pub use figures::{DRIVEN, Figures};
#[cfg(feature = "figures")]
pub use html::html;
pub use law::{Flavour, Law, LawKind};
pub use study::{BenchError, Run, Settings, runs, study};
pub use summary::{ALLOWED_S, Row, Spread, Summary, summaries};
pub use table::{Cell, HEADER, better, cells, console, label, markdown, verdict};
pub use tracks::{BadFile, FILES, Named, TrackFile};
pub use tuned::Tuned;
pub use tuning::{evaluations, tune};

/// What is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Track {
    /// The paper's line and curve, and the rest at their end.
    Paper,
    /// From rest to a pose.
    Parking,
    /// Trajectory files, from beside their path to rest at their end.
    Files,
    /// Steps of ordered speed and turn rate.
    Velocity,
}

impl Track {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Parking, Self::Files, Self::Paper, Self::Velocity];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Parking => "parking",
            Self::Files => "files",
            Self::Velocity => "velocity",
        }
    }
}

/// Where it is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Plant {
    /// Exact poses, exact torques.
    Ideal,
    /// The base file's hardware; mass and inertia within ±30 %, battery at 80 to 100 %.
    Realistic,
    /// [`crate::trials::setup`], everything drawn.
    BadFloor,
}

impl Plant {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Ideal, Self::Realistic, Self::BadFloor];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ideal => "ideal",
            Self::Realistic => "realistic",
            Self::BadFloor => "bad floor",
        }
    }
}

/// A track on a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Class {
    /// What.
    pub track: Track,
    /// Where.
    pub plant: Plant,
}

impl Class {
    /// All of them, in the order of tables.
    pub fn all() -> Vec<Self> {
        let plants = |track| Plant::ALL.map(|plant| Self { track, plant });
        Track::ALL.into_iter().flat_map(plants).collect()
    }

    /// For people.
    pub fn name(self) -> String {
        format!("{}, {}", self.track.name(), self.plant.name())
    }
}

/// Arrived: within this distance of the goal \[m\] and this heading \[rad\], for good.
pub const ARRIVED: (f64, f64) = (0.010, 0.020);
/// What is asked of parking: time over least time, median, nine tenths and all; on the ideal plant, and on real hardware
/// after [`ALLOWED_S`].
pub const TIMES_ASKED: [(Plant, [f64; 3]); 2] = [
    (Plant::Ideal, [1.2, 1.4, 1.6]),
    (Plant::Realistic, [1.5, 2.0, 2.5]),
];
/// What is asked of the end of a run \[m, rad\]: who is closer has no advantage in a comparison of times.
pub const ASKED: (f64, f64) = (0.005, 0.010);
