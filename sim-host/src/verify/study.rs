//! All runs, side by side.

use super::{badness, grid, shortcoming};
use crate::closed_loop::ClosedLoopError;
use crate::mission::{BaseSpec, Mission};
use crate::part;
use crate::rate::Rate;
use crate::run::Watch;
use crate::trace::Trace;
use crate::trials::{self, Condition, Course, Figures};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::ops::Range;

/// Why there is no result either way.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{course}, {condition}: {cause}")]
pub struct VerifyError {
    course: &'static str,
    condition: &'static str,
    cause: ClosedLoopError,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// What it did.
    pub course: Course,
    /// Where.
    pub condition: Condition,
    /// Of everything that is drawn.
    pub seed: u64,
    /// What came of it.
    pub figures: Figures,
}

/// A course under a condition, over all seeds. Worst values are of the runs that parked, but for errors and
/// times of a case in which none did.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// `line`, `curve` or `park`.
    pub course: &'static str,
    /// Of the world.
    pub condition: &'static str,
    /// Number of runs.
    pub runs: usize,
    /// How many parked.
    pub parked: usize,
    /// How many did all that is asked.
    pub good: usize,
    /// Largest true distance to the goal \[m\].
    pub error_m: f64,
    /// Largest true heading error \[rad\].
    pub error_rad: f64,
    /// Mean time until parked \[s\].
    pub mean_s: f64,
    /// Longest \[s\].
    pub longest_s: f64,
    /// Largest ripple at rest, over the limit; none if none parked.
    pub ripple: Option<f64>,
    /// Largest use of a limit, and of which.
    pub peak: Option<trials::Peak>,
    /// What runs stopped for, with their number.
    pub stopped: BTreeMap<String, usize>,
    /// Faults that were found, ignored or not, with the number of runs.
    pub found: BTreeMap<&'static str, usize>,
}

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// In the order of courses, conditions, seeds.
    pub runs: Vec<Run>,
    /// In the order of courses and conditions.
    pub cases: Vec<Case>,
}

/// Number of runs that [`verify`] makes.
pub const fn runs(seeds: NonZeroU32) -> u64 {
    grid().len() as u64 * seeds.get() as u64
}

/// Runs every course under every condition, `seeds` times each with seeds `first`, `first` + 1, ...; the same runs
/// for any number of threads. `begun` is called at the beginning of each; it may unwind, which ends the study.
///
/// # Errors
/// A base or a world out of range.
pub fn verify(
    base: &BaseSpec,
    first: u64,
    seeds: NonZeroU32,
    begun: impl Fn() + Sync,
) -> Result<Verification, VerifyError> {
    let all = 0..usize::try_from(runs(seeds)).unwrap_or(usize::MAX);
    Ok(Verification::of(runs_at(base, first, seeds, all, begun)?))
}

/// Those of the runs of [`verify`] that have these places in it.
pub(super) fn runs_at(
    base: &BaseSpec,
    first: u64,
    seeds: NonZeroU32,
    places: Range<usize>,
    begun: impl Fn() + Sync,
) -> Result<Vec<Run>, VerifyError> {
    let cases = grid().map(|(course, condition)| (course.mission(base), course, condition));
    let seeds = seeds.get() as usize;
    let run = |place: usize| {
        let (mission, course, condition) = &cases[place / seeds];
        let seed = first.wrapping_add((place % seeds) as u64);
        begun();
        let (_, figures) = run(mission, *course, *condition, seed, None)?;
        Ok(Run {
            course: *course,
            condition: *condition,
            seed,
            figures,
        })
    };
    let places = places.start..places.end.min(cases.len() * seeds);
    let pieces: Result<Vec<Vec<Run>>, _> = part::in_pieces(places, run).collect();
    Ok(pieces?.into_iter().flatten().collect())
}

fn run(
    mission: &Mission,
    course: Course,
    condition: Condition,
    seed: u64,
    watch: Watch<'_>,
) -> Result<(Trace, Figures), VerifyError> {
    let setup = trials::setup(&mission.base, condition, seed);
    trials::run_watched(mission, &setup, watch).map_err(|cause| VerifyError {
        course: course.name(),
        condition: condition.name(),
        cause,
    })
}

impl Verification {
    /// Of all runs, in their order.
    pub fn of(runs: Vec<Run>) -> Self {
        let cases = runs.chunk_by(|a, b| (a.course, a.condition) == (b.course, b.condition));
        Self {
            cases: cases.filter_map(Case::of).collect(),
            runs,
        }
    }

    /// How many runs did not do all that is asked.
    pub fn failures(&self) -> Rate {
        let good: usize = self.cases.iter().map(|case| case.good).sum();
        Rate {
            failed: self.runs.len() - good,
            runs: self.runs.len(),
        }
    }

    /// The time within which a share of the runs of a course was parked \[s\]; infinite if fewer parked.
    pub fn parked_within_s(&self, course: Course, share: f64) -> f64 {
        let of_course = self.runs.iter().filter(|run| run.course == course);
        let time = |run: &Run| match run.figures.parked {
            true => run.figures.time_s,
            false => f64::INFINITY,
        };
        let mut times: Vec<f64> = of_course.map(time).collect();
        times.sort_by(f64::total_cmp);
        let rank = (share * times.len() as f64).ceil().max(1.0) as usize;
        times.get(rank - 1).copied().unwrap_or(f64::INFINITY)
    }

    /// Whether every run did all that is asked.
    pub fn holds(&self) -> bool {
        self.failures().failed == 0
    }

    /// The worst run: one that did not park, if there is one, else the one farthest off.
    pub fn worst(&self) -> Option<&Run> {
        let runs = self.runs.iter();
        runs.reduce(|a, b| match badness(&b.figures) > badness(&a.figures) {
            true => b,
            false => a,
        })
    }
}

impl Run {
    /// The run again, with its trace.
    ///
    /// # Errors
    /// None that the run itself did not have.
    pub fn again(&self, base: &BaseSpec) -> Result<Trace, VerifyError> {
        self.again_watched(base, None)
    }

    /// As [`again`](Self::again), and `watch` sees every tick.
    ///
    /// # Errors
    /// As [`again`](Self::again).
    pub fn again_watched(&self, base: &BaseSpec, watch: Watch<'_>) -> Result<Trace, VerifyError> {
        let mission = self.course.mission(base);
        let again = run(&mission, self.course, self.condition, self.seed, watch);
        again.map(|(trace, _)| trace)
    }
}

impl Case {
    fn of(runs: &[Run]) -> Option<Self> {
        let first = runs.first()?;
        let all = || runs.iter().map(|run| &run.figures);
        let parked = all().filter(|figures| figures.parked).count();
        // Where none parked, how far they came still says something.
        let counted = || all().filter(|figures| figures.parked || parked == 0);
        let largest = |figure: fn(&Figures) -> f64| counted().map(figure).fold(0.0, f64::max);
        let peaks = all().filter_map(|figures| figures.peak);
        let (mut stopped, mut found) = (BTreeMap::new(), BTreeMap::new());
        for figures in all() {
            if let Some(stop) = &figures.stopped {
                *stopped.entry(stop.cause.clone()).or_default() += 1;
            }
            for name in &figures.found {
                *found.entry(*name).or_default() += 1;
            }
        }
        Some(Self {
            course: first.course.name(),
            condition: first.condition.name(),
            runs: runs.len(),
            parked,
            good: all().filter(|f| shortcoming(f).is_none()).count(),
            error_m: largest(|figures| figures.error_m),
            error_rad: largest(|figures| figures.error_rad),
            mean_s: counted().map(|f| f.time_s).sum::<f64>() / counted().count().max(1) as f64,
            longest_s: largest(|figures| figures.time_s),
            ripple: all().filter_map(|figures| figures.ripple).reduce(f64::max),
            peak: peaks.reduce(|a, b| if b.share > a.share { b } else { a }),
            stopped,
            found,
        })
    }
}
