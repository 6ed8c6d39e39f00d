//! The search.

use super::knobs::{KNOBS, gains, logs};
use super::problem::{Seeds, TuneError, TuningProblem};
use super::score::Score;
use super::simplex;
use controller_core::motion::MotionGains;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::ops::Range;

/// Most sets of a search: those of the first look are drawn before any is tried.
pub const MAX_EVALUATIONS: u64 = 1_000_000;

/// How much is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Sets of gains that are tried, over all starts; at least one each.
    pub evaluations: u64,
    /// Simplexes, each from one of the best sets of the first look. At least 1.
    pub starts: usize,
    /// Worlds in which each set is tried, for each mission; those that the starts end with in three times as many.
    pub training: usize,
    /// Worlds in which the first and the last set are compared.
    pub unseen: usize,
    /// Settles everything that is drawn.
    pub seed: u64,
}

impl Default for Search {
    /// A first look at 80 sets, then 53 from each of the best three: five times round a simplex of nine
    /// corners. Four worlds keep noise below what gains change; eight that were not seen tell whether it
    /// was noise after all.
    fn default() -> Self {
        Self {
            evaluations: 240,
            starts: 3,
            training: 4,
            unseen: 8,
            seed: 1,
        }
    }
}

/// What came of a search; of each pair the first is before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// Gains.
    pub gains: [MotionGains<f64>; 2],
    /// In the worlds of the search.
    pub training: [Score; 2],
    /// In worlds that it did not see.
    pub unseen: [Score; 2],
}

/// Factors on the velocity loops and the disturbance estimate in the first look. Those that follow from the
/// limits suit a base without friction; stiction needs several times more, noise for less.
const LOOPS: [f64; 4] = [0.5, 2.0, 4.0, 6.0];

/// Looks for gains; `begun` is called at the beginning of each trial of a set. It may unwind, which ends the search.
///
/// The base's own gains are kept if nothing better was found.
///
/// # Errors
/// A base or a world out of range.
pub fn search(
    problem: &TuningProblem,
    search: &Search,
    begun: impl Fn() + Sync,
) -> Result<Tuned, TuneError> {
    let found = finds(problem, search, 0..search.finds(), begun)?;
    conclude(problem, search, &found)
}

/// What a first look or a start ended with: the cost in the worlds of the search, and the gains' logarithms; none of a
/// start that had nothing to spend.
pub type Find = Option<(f64, Vec<f64>)>;

impl Search {
    /// How many finds there are: that of the look, then one of each start.
    pub fn finds(&self) -> usize {
        1 + self.starts.clamp(1, simplex::look(self.evaluations))
    }

    /// How many sets are tried for those of these places. All starts need the whole look.
    pub fn trials(&self, places: &Range<usize>) -> u64 {
        let look = simplex::look(self.evaluations);
        let starts = places.len() - usize::from(places.contains(&0));
        match places.is_empty() {
            true => 0,
            false => look as u64 + starts as u64 * self.budget(),
        }
    }

    fn budget(&self) -> u64 {
        simplex::budget(
            self.evaluations,
            simplex::look(self.evaluations),
            self.starts,
        )
    }
}

/// The finds of these places, see [`Search::finds`].
///
/// # Errors
/// A base or a world out of range.
pub fn finds(
    problem: &TuningProblem,
    search: &Search,
    places: Range<usize>,
    begun: impl Fn() + Sync,
) -> Result<Vec<Find>, TuneError> {
    if places.is_empty() {
        return Ok(Vec::new());
    }
    let seeds = Seeds::Training.draw(search.seed, search.training);
    let before = problem.base().motion().gains;
    let cost = |logs: &[f64]| {
        begun();
        Ok(problem.score(&gains(&before, logs), &seeds)?.total())
    };
    let look = simplex::look(search.evaluations);
    let looked = simplex::rate(candidates(problem, search.seed, look), cost, || {})?;
    let find = |place: usize| match place.checked_sub(1) {
        None => Ok(looked.first().cloned()),
        Some(start) => looked.get(start).map_or(Ok(None), |(_, start)| {
            simplex::descend(start, search.budget(), cost, || {})
        }),
    };
    places.into_par_iter().map(find).collect()
}

/// What came of a search that found this.
///
/// # Errors
/// A base or a world out of range.
pub fn conclude(
    problem: &TuningProblem,
    search: &Search,
    found: &[Find],
) -> Result<Tuned, TuneError> {
    let seeds = Seeds::Training.draw(search.seed, search.training);
    let before = problem.base().motion().gains;
    let found = found.iter().flatten().map(|(_, logs)| gains(&before, logs));
    let both = [before, elect(problem, search, before, found)?];
    let training = [
        problem.score(&both[0], &seeds)?,
        problem.score(&both[1], &seeds)?,
    ];
    let seeds = Seeds::Unseen.draw(search.seed, search.unseen);
    let unseen = [
        problem.score(&both[0], &seeds)?,
        problem.score(&both[1], &seeds)?,
    ];
    Ok(Tuned {
        gains: both,
        training,
        unseen,
    })
}

/// The best of the gains before and of those that the starts ended with, in the worlds of the search and twice as many
/// new ones: the best of hundreds in a few worlds owes some of that to these worlds.
fn elect(
    problem: &TuningProblem,
    search: &Search,
    before: MotionGains<f64>,
    found: impl Iterator<Item = MotionGains<f64>>,
) -> Result<MotionGains<f64>, TuneError> {
    let seeds = Seeds::Training.draw(search.seed, 3 * search.training);
    let mut best = (problem.score(&before, &seeds)?.total(), before);
    for gains in found {
        let cost = problem.score(&gains, &seeds)?.total();
        // The first of equals.
        if cost < best.0 {
            best = (cost, gains);
        }
    }
    Ok(best.1)
}

/// What the first look tries: the base's own gains and those that follow from its limits, both with slower
/// and faster velocity loops, then drawn ones around them.
fn candidates(problem: &TuningProblem, seed: u64, count: usize) -> Vec<Vec<f64>> {
    let own = logs(&problem.base().motion().gains);
    let mut plain = problem.base().clone();
    plain.gains = None;
    let suited = logs(&plain.motion().gains);
    let mut all = vec![own, suited];
    for factor in LOOPS {
        for centre in 0..2 {
            let mut logs = all[centre].clone();
            for (log, knob) in logs.iter_mut().zip(KNOBS) {
                if matches!(knob.key, "speed_loop" | "turn_loop" | "disturbance") {
                    *log += libm::log(factor);
                }
            }
            all.push(logs);
        }
    }
    let centres = all.len();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    while all.len() < count {
        let near = |log: &f64| -> f64 {
            let normal: f64 = StandardNormal.sample(&mut random);
            log + simplex::SPREAD * normal
        };
        let drawn = all[all.len() % centres].iter().map(near).collect();
        all.push(drawn);
    }
    all.truncate(count);
    all
}
