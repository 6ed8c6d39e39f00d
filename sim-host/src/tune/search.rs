//! The search.

use super::knobs::{KNOBS, gains, logs};
use super::score::Score;
use super::wish::{Seeds, TuneError, Wish};
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
    /// Starts: the base's own gains, those that follow from its limits, then drawn ones. At least 1.
    pub starts: usize,
    /// Worlds in which each set is tried, for each mission.
    pub training: usize,
    /// Worlds in which the first and the last set are compared.
    pub unseen: usize,
    /// Settles everything that is drawn.
    pub seed: u64,
}

impl Default for Search {
    /// 60 sets from each of four starts: six times round a simplex of nine corners. Four worlds keep noise
    /// below what gains change; eight that were not seen tell whether it was noise after all.
    fn default() -> Self {
        Self {
            evaluations: 240,
            starts: 4,
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
/// Standard deviation of the logarithms of drawn starts: mostly within a factor of 2.
const SPREAD: f64 = 0.4;
/// Gains stay within this factor of those that follow from the limits (ln 10) or of their start; beyond it
/// each natural logarithm costs a point.
const REACH: f64 = 2.303;

/// Looks for gains; `done` is called after each set that was tried.
///
/// The base's own gains are kept if nothing better was found.
///
/// # Errors
/// A base or a world out of range.
pub fn search(wish: &Wish, search: &Search, done: impl Fn() + Sync) -> Result<Tuned, TuneError> {
    let seeds = Seeds::Training.draw(search.seed, search.training);
    let starts = starts(wish, search);
    let budget = (search.evaluations / starts.len().max(1) as u64).max(1);
    let before = wish.base().motion().gains;
    let found = starts.into_par_iter().map(|start| {
        let state = Mutex::default();
        let problem = Problem {
            wish,
            seeds: &seeds,
            start: start.clone(),
            budget,
            state: &state,
            done: &done,
        };
        let solver = NelderMead::new(simplex(&start));
        // Ends by the budget, which is an error to it: what was found is in the state.
        let _ = Executor::new(problem, solver)
            .configure(|state| state.max_iters(budget))
            .timer(false)
            .run();
        let state = state.into_inner().unwrap_or_else(|held| held.into_inner());
        state.failed.map_or(Ok(state.best), Err)
    });
    let found: Vec<_> = found.collect::<Result<_, _>>()?;
    let best = found.into_iter().flatten();
    // The first of equals, whatever the threads did.
    let best = best.reduce(|a, b| if b.0 < a.0 { b } else { a });
    let mut training = [wish.score(&before, &seeds)?; 2];
    let mut both = [before; 2];
    if let Some((cost, gains)) = best
        && cost < training[0].total()
    {
        both[1] = gains;
        training[1] = wish.score(&gains, &seeds)?;
    }
    let seeds = Seeds::Unseen.draw(search.seed, search.unseen);
    let unseen = [wish.score(&both[0], &seeds)?, wish.score(&both[1], &seeds)?];
    Ok(Tuned {
        gains: both,
        training,
        unseen,
    })
}

fn starts(wish: &Wish, search: &Search) -> Vec<Vec<f64>> {
    let own = logs(&wish.base().motion().gains);
    let mut plain = wish.base().clone();
    plain.gains = None;
    let suited = logs(&plain.motion().gains);
    let mut starts = vec![own];
    if starts[0] != suited {
        starts.push(suited.clone());
    }
    let mut random = Pcg64Mcg::seed_from_u64(search.seed);
    while starts.len() < search.starts {
        let near = |log: &f64| -> f64 {
            let normal: f64 = StandardNormal.sample(&mut random);
            log + SPREAD * normal
        };
        starts.push(suited.iter().map(near).collect());
    }
    starts.truncate(search.starts.max(1));
    starts
}

/// A corner at the start and one beyond it for each knob, slower: gains that are too high are the usual trouble.
fn simplex(start: &[f64]) -> Vec<Vec<f64>> {
    let mut corners = vec![start.to_vec()];
    for knob in 0..KNOBS.len() {
        let step = |(at, log): (usize, &f64)| if at == knob { log + STEP } else { *log };
        corners.push(start.iter().enumerate().map(step).collect());
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
    wish: &'a Wish,
    seeds: &'a [u64],
    start: Vec<f64>,
    budget: u64,
    state: &'a Mutex<State>,
    done: &'a F,
}

#[derive(Debug, thiserror::Error)]
#[error("all evaluations are spent")]
struct Spent;

impl<F: Fn() + Sync> CostFunction for Problem<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Self::Param) -> Result<f64, Error> {
        let state = || self.state.lock().unwrap_or_else(|held| held.into_inner());
        if state().spent >= self.budget {
            return Err(Spent.into());
        }
        let inside = at.iter().zip(&self.start);
        let inside: Vec<f64> = inside
            .map(|(log, start)| log.clamp(start - REACH, start + REACH))
            .collect();
        let beyond: f64 = at.iter().zip(&inside).map(|(a, b)| (a - b).abs()).sum();
        let gains = gains(&self.wish.base().motion().gains, &inside);
        let score = self.wish.score(&gains, self.seeds);
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
                Err(Spent.into())
            }
        }
    }
}
