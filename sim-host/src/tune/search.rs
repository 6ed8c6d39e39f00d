//! The search.

use super::knobs::{KNOBS, gains, logs};
use super::problem::{Seeds, TuneError, TuningProblem};
use super::score::Score;
use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::neldermead::NelderMead;
use controller_core::motion::MotionGains;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::sync::Mutex;

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

/// First step of the simplex: a factor of 1.5 on a gain, more than noise hides and less than upsets a loop.
const STEP: f64 = 0.405;
/// Standard deviation of the logarithms of drawn sets: mostly within a factor of 2.7.
const SPREAD: f64 = 0.5;
/// Share of the evaluations that the first look takes.
const LOOK: u64 = 3;
/// Factors on the velocity loops and the disturbance estimate in the first look. Those that follow from the
/// limits suit a base without friction; stiction needs several times more, noise for less.
const LOOPS: [f64; 4] = [0.5, 2.0, 4.0, 6.0];
/// Gains stay within a factor of 10 of their start (ln 10); each natural logarithm beyond it costs a point.
const REACH: f64 = 2.303;

/// Looks for gains; `done` is called after each set that was tried.
///
/// The base's own gains are kept if nothing better was found.
///
/// # Errors
/// A base or a world out of range.
pub fn search(
    problem: &TuningProblem,
    search: &Search,
    done: impl Fn() + Sync,
) -> Result<Tuned, TuneError> {
    let seeds = Seeds::Training.draw(search.seed, search.training);
    let before = problem.base().motion().gains;
    let look = usize::try_from(search.evaluations / LOOK).unwrap_or(usize::MAX);
    let looked = candidates(problem, search.seed, look.max(1));
    let looked = looked.into_par_iter().map(|logs| {
        let gains = gains(&before, &logs);
        let cost = problem.score(&gains, &seeds)?.total();
        done();
        Ok((cost, gains, logs))
    });
    let mut looked: Vec<_> = looked.collect::<Result<_, TuneError>>()?;
    // Stable: equals stay in their order.
    looked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let seen = looked.first().map(|(cost, gains, _)| (*cost, *gains));
    let rest = search.evaluations.saturating_sub(looked.len() as u64);
    let starts: Vec<_> = looked.into_iter().take(search.starts.max(1)).collect();
    let budget = rest / starts.len().max(1) as u64;
    let starts: Vec<Vec<f64>> = starts.into_iter().map(|(_, _, logs)| logs).collect();
    let found = starts.into_par_iter().map(|start| {
        let state = Mutex::default();
        let problem = Problem {
            problem,
            seeds: &seeds,
            start: start.clone(),
            budget,
            state: &state,
            done: &done,
        };
        let solver = NelderMead::new(simplex(&start));
        // What it found is in the state; its own end does not matter.
        let _ = Executor::new(problem, solver)
            .configure(|state| state.max_iters(budget))
            .timer(false)
            .run();
        let state = state.into_inner().unwrap_or_else(|held| held.into_inner());
        state.failed.map_or(Ok(state.best), Err)
    });
    let found: Vec<_> = found.collect::<Result<_, _>>()?;
    let found = seen.into_iter().chain(found.into_iter().flatten());
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
    found: impl Iterator<Item = (f64, MotionGains<f64>)>,
) -> Result<MotionGains<f64>, TuneError> {
    let seeds = Seeds::Training.draw(search.seed, 3 * search.training);
    let mut best = (problem.score(&before, &seeds)?.total(), before);
    for (_, gains) in found {
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
            log + SPREAD * normal
        };
        let drawn = all[all.len() % centres].iter().map(near).collect();
        all.push(drawn);
    }
    all.truncate(count);
    all
}

/// A corner at the start and one beyond it for each knob, up and down in turn, so that the corners do not
/// all lie to one side.
fn simplex(start: &[f64]) -> Vec<Vec<f64>> {
    let mut corners = vec![start.to_vec()];
    for knob in 0..KNOBS.len() {
        let step = if knob % 2 == 0 { STEP } else { -STEP };
        let moved = |(at, log): (usize, &f64)| if at == knob { log + step } else { *log };
        corners.push(start.iter().enumerate().map(moved).collect());
    }
    corners
}

/// What a start has come to.
#[derive(Debug, Default)]
struct State {
    spent: u64,
    best: Option<(f64, MotionGains<f64>)>,
    failed: Option<TuneError>,
}

struct Problem<'a, F> {
    problem: &'a TuningProblem,
    seeds: &'a [u64],
    start: Vec<f64>,
    budget: u64,
    state: &'a Mutex<State>,
    done: &'a F,
}

impl<F: Fn() + Sync> CostFunction for Problem<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Self::Param) -> Result<f64, Error> {
        let state = || self.state.lock().unwrap_or_else(|held| held.into_inner());
        if state().spent >= self.budget {
            // The simplex takes no error; nothing is better than this from here on.
            return Ok(f64::INFINITY);
        }
        let inside = at.iter().zip(&self.start);
        let inside: Vec<f64> = inside
            .map(|(log, start)| log.clamp(start - REACH, start + REACH))
            .collect();
        let beyond: f64 = at.iter().zip(&inside).map(|(a, b)| (a - b).abs()).sum();
        let gains = gains(&self.problem.base().motion().gains, &inside);
        let score = self.problem.score(&gains, self.seeds);
        (self.done)();
        let mut state = state();
        state.spent += 1;
        match score {
            Ok(score) => {
                let cost = score.total() + beyond;
                if state.best.as_ref().is_none_or(|(best, _)| cost < *best) {
                    state.best = Some((cost, gains));
                }
                Ok(cost)
            }
            Err(error) => {
                state.failed = Some(error);
                Ok(f64::INFINITY)
            }
        }
    }
}
