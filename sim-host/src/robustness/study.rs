//! All runs, side by side.

use super::closed_loop::{Run, RunVerdict, run};
use super::condition::Condition;
use super::law::ComparedLaw;
use super::{Case, StudyError};
use controller_core::maths::{Libm, Maths};
use controller_core::types::Wrench;
use rayon::prelude::*;
use std::num::NonZeroU32;

/// A figure over the seeds of a condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// The largest.
    pub worst: f64,
}

/// What came of a condition, a case and a law, over all its seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyOutcome {
    /// Number of runs: 1 without noise.
    pub runs: usize,
    /// How many of them arrived.
    pub arrived: usize,
    /// Settling time \[s\]; none unless all settled.
    pub settling_s: Option<Spread>,
    /// Parking time \[s\]; none unless all parked.
    pub parked_s: Option<Spread>,
    /// Distance to the goal at the end \[m\].
    pub final_m: Spread,
    /// Heading error at the end \[rad\].
    pub final_rad: Spread,
    /// Root mean square of [`Run::following_std`].
    pub following_std: Wrench<f64>,
    /// Root mean square of [`Run::rest_std`].
    pub rest_std: Wrench<f64>,
    /// Largest force of all runs \[N\].
    pub peak_force_n: f64,
    /// Largest moment of all runs \[N m\].
    pub peak_moment_nm: f64,
    /// The worst of all runs.
    pub verdict: RunVerdict,
}

/// A row of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRow<'a> {
    /// Under what.
    pub condition: &'a Condition,
    /// Along what.
    pub case: Case,
    /// By whom.
    pub law: ComparedLaw,
    /// And what came of it.
    pub outcome: StudyOutcome,
}

/// Number of runs that [`study`] makes.
pub fn runs(conditions: &[Condition], seeds: NonZeroU32) -> u64 {
    let per_law = conditions.iter().map(|c| seeds_of(c, seeds)).sum::<u64>();
    per_law * (Case::ALL.len() * ComparedLaw::ALL.len()) as u64
}

/// Runs every condition with both cases and all laws; those with noise `seeds` times.
///
/// The seed of a run is its number, 0 to `seeds` − 1: laws meet the same noise, and nothing depends
/// on the number of threads, which is rayon's. Rows are in the order of conditions, cases, laws.
/// `done` is called after each run.
///
/// # Errors
/// See [`run`].
pub fn study<'a>(
    conditions: &'a [Condition],
    seeds: NonZeroU32,
    done: impl Fn() + Sync,
) -> Result<Vec<StudyRow<'a>>, StudyError> {
    Ok(rows(
        conditions,
        seeds,
        &run_all(places(conditions, seeds), done)?,
    ))
}

/// A place of a study: what is run there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub condition: &'a Condition,
    pub case: Case,
    pub law: ComparedLaw,
    pub seed: u64,
}

/// All runs, in the order of conditions, cases, laws, seeds.
pub(super) fn places(conditions: &[Condition], seeds: NonZeroU32) -> Vec<Place<'_>> {
    let mut places = Vec::new();
    for (condition, case, law) in combinations(conditions) {
        places.extend((0..seeds_of(condition, seeds)).map(|seed| Place {
            condition,
            case,
            law,
            seed,
        }));
    }
    places
}

fn combinations(conditions: &[Condition]) -> impl Iterator<Item = (&Condition, Case, ComparedLaw)> {
    let cases = |condition| Case::ALL.map(|case| (condition, case));
    let of_cases = conditions.iter().flat_map(cases);
    of_cases.flat_map(|(condition, case)| ComparedLaw::ALL.map(|law| (condition, case, law)))
}

pub(super) fn run_all(
    places: Vec<Place<'_>>,
    done: impl Fn() + Sync,
) -> Result<Vec<Run>, StudyError> {
    let runs = places.into_par_iter().map(|place| {
        let run = run(
            &place.condition.disturbance,
            place.case,
            place.law,
            place.seed,
        );
        done();
        run
    });
    runs.collect()
}

/// What came of all runs of a study, which are in its order.
pub fn rows<'a>(conditions: &'a [Condition], seeds: NonZeroU32, runs: &[Run]) -> Vec<StudyRow<'a>> {
    let mut runs = runs.iter();
    let combinations = combinations(conditions).map(|(condition, case, law)| {
        let count = usize::try_from(seeds_of(condition, seeds)).unwrap_or(usize::MAX);
        let of_row: Vec<Run> = runs.by_ref().take(count).copied().collect();
        StudyRow {
            condition,
            case,
            law,
            outcome: StudyOutcome::of(&of_row),
        }
    });
    combinations.collect()
}

fn seeds_of(condition: &Condition, seeds: NonZeroU32) -> u64 {
    if condition.disturbance.is_random() {
        u64::from(seeds.get())
    } else {
        1
    }
}

impl StudyOutcome {
    fn of(runs: &[Run]) -> Self {
        let count = runs.len().max(1) as f64;
        let all = |pick: fn(&Run) -> f64| Spread::of(runs.iter().map(pick));
        let when = |pick: fn(&Run) -> Option<f64>| {
            let times: Option<Vec<f64>> = runs.iter().map(pick).collect();
            times.map(|times| Spread::of(times.into_iter()))
        };
        let pooled = |pick: fn(&Run) -> Wrench<f64>| {
            let root = |part: fn(Wrench<f64>) -> f64| {
                Libm::sqrt(runs.iter().map(|run| part(pick(run)).powi(2)).sum::<f64>() / count)
            };
            Wrench {
                force: root(|wrench| wrench.force),
                moment: root(|wrench| wrench.moment),
            }
        };
        let verdicts = runs.iter().map(|run| run.verdict);
        Self {
            runs: runs.len(),
            arrived: verdicts
                .clone()
                .filter(|v| *v == RunVerdict::Arrived)
                .count(),
            settling_s: when(|run| run.settling_s),
            parked_s: when(|run| run.parked_s),
            final_m: all(|run| run.final_m),
            final_rad: all(|run| run.final_rad),
            following_std: pooled(|run| run.following_std),
            rest_std: pooled(|run| run.rest_std),
            peak_force_n: all(|run| run.peak_force_n).worst,
            peak_moment_nm: all(|run| run.peak_moment_nm).worst,
            verdict: verdicts.max().unwrap_or_default(),
        }
    }
}

impl Spread {
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count().max(1) as f64;
        Self {
            mean: values.clone().sum::<f64>() / count,
            worst: values.fold(0.0, f64::max),
        }
    }
}
