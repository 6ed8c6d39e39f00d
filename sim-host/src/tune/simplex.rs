//! Nelder and Mead's simplex over logarithms of gains, from the best of a first look.

use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::neldermead::NelderMead;
use rayon::prelude::*;
use std::sync::Mutex;

/// First step of the simplex: a factor of 1.5 on a gain, more than noise hides and less than upsets a loop.
const STEP: f64 = 0.405;
/// Standard deviation of the logarithms of drawn sets: mostly within a factor of 2.7.
pub(crate) const SPREAD: f64 = 0.5;
/// Share of the evaluations that the first look takes.
const LOOK: u64 = 3;
/// Gains stay within a factor of 10 of their start (ln 10); each natural logarithm beyond it costs a point.
const REACH: f64 = 2.303;

/// How many sets the first look has of so many evaluations.
pub(crate) fn look(evaluations: u64) -> usize {
    usize::try_from(evaluations / LOOK)
        .unwrap_or(usize::MAX)
        .max(1)
}

/// Rates the sets of a first look, and goes on from the best of them, a simplex each, until `evaluations` are spent. The
/// best of the look and those that the starts ended with, with their costs. `done` is called after each set.
pub(crate) fn minimise<E: Send>(
    looked: Vec<Vec<f64>>,
    (evaluations, starts): (u64, usize),
    cost: impl Fn(&[f64]) -> Result<f64, E> + Sync,
    done: impl Fn() + Sync,
) -> Result<Vec<Rated>, E> {
    let looked = rate(looked, &cost, &done)?;
    let budget = budget(evaluations, looked.len(), starts);
    let starts = looked.par_iter().take(starts.max(1));
    let found = starts.map(|(_, start)| descend(start, budget, &cost, &done));
    let found: Vec<_> = found.collect::<Result<_, _>>()?;
    let seen = looked.first().cloned();
    Ok(seen
        .into_iter()
        .chain(found.into_iter().flatten())
        .collect())
}

/// A set with its cost.
pub(crate) type Rated = (f64, Vec<f64>);

/// The sets of a first look, the best first. `done` is called after each set.
pub(crate) fn rate<E: Send>(
    looked: Vec<Vec<f64>>,
    cost: impl Fn(&[f64]) -> Result<f64, E> + Sync,
    done: impl Fn() + Sync,
) -> Result<Vec<Rated>, E> {
    let looked = looked.into_par_iter().map(|logs| {
        let value = cost(&logs)?;
        done();
        Ok((value, logs))
    });
    let mut looked: Vec<_> = looked.collect::<Result<_, E>>()?;
    // Stable: equals stay in their order.
    looked.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(looked)
}

/// What each of the starts may spend of the evaluations after a look of so many sets.
pub(crate) fn budget(evaluations: u64, looked: usize, starts: usize) -> u64 {
    evaluations.saturating_sub(looked as u64) / starts.max(1).min(looked.max(1)) as u64
}

/// The best that a simplex finds from a start; none if it may spend nothing.
pub(crate) fn descend<E: Send>(
    start: &[f64],
    budget: u64,
    cost: impl Fn(&[f64]) -> Result<f64, E> + Sync,
    done: impl Fn() + Sync,
) -> Result<Option<Rated>, E> {
    let state = Mutex::new(State {
        spent: 0,
        best: None,
        failed: None,
    });
    let problem = Problem {
        cost: &cost,
        start: start.to_vec(),
        budget,
        state: &state,
        done: &done,
    };
    let solver = NelderMead::new(corners(start));
    // What it found is in the state; its own end does not matter.
    let _ = Executor::new(problem, solver)
        .configure(|state| state.max_iters(budget))
        .timer(false)
        .run();
    let state = state.into_inner().unwrap_or_else(|held| held.into_inner());
    state.failed.map_or(Ok(state.best), Err)
}

/// A corner at the start and one beyond it for each gain, up and down in turn, so that the corners do not
/// all lie to one side.
fn corners(start: &[f64]) -> Vec<Vec<f64>> {
    let mut corners = vec![start.to_vec()];
    for knob in 0..start.len() {
        let step = if knob % 2 == 0 { STEP } else { -STEP };
        let moved = |(at, log): (usize, &f64)| if at == knob { log + step } else { *log };
        corners.push(start.iter().enumerate().map(moved).collect());
    }
    corners
}

/// What a start has come to.
struct State<E> {
    spent: u64,
    best: Option<Rated>,
    failed: Option<E>,
}

struct Problem<'a, C, F, E> {
    cost: &'a C,
    start: Vec<f64>,
    budget: u64,
    state: &'a Mutex<State<E>>,
    done: &'a F,
}

impl<C, F, E> CostFunction for Problem<'_, C, F, E>
where
    C: Fn(&[f64]) -> Result<f64, E> + Sync,
    F: Fn() + Sync,
    E: Send,
{
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
        let value = (self.cost)(&inside);
        (self.done)();
        let mut state = state();
        state.spent += 1;
        match value {
            Ok(value) => {
                let value = value + beyond;
                if state.best.as_ref().is_none_or(|(best, _)| value < *best) {
                    state.best = Some((value, inside));
                }
                Ok(value)
            }
            Err(error) => {
                state.failed = Some(error);
                Ok(f64::INFINITY)
            }
        }
    }
}
