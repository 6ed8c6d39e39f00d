//! All runs, side by side.

use super::fault_injection::FaultInjectionKind;
use super::outcome::{RunOutcome, Violation};
use super::plan::{Bases, Plan};
use super::report::run_sheet;
use super::run::{Mutation, run};
use crate::closed_loop::ClosedLoopError;
use crate::csv_out::Sheet;
use crate::part::Study;
use crate::scenario::{BASES, GYRO, ScenarioError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// No kind of trouble has one of the words in its name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no trouble has such a word in its name; there are: {}", .0.join(", "))]
pub struct NoTrouble(pub Vec<&'static str>);

/// Numbers of `count` runs from `first` on, of troubles whose name has one of the words `only`; of all if there is none.
///
/// # Errors
/// Words that no trouble has.
fn numbers(bases: &Bases, first: u64, count: u64, only: &[String]) -> Result<Vec<u64>, NoTrouble> {
    let chosen = |kind: FaultInjectionKind| {
        only.is_empty() || only.iter().any(|text| kind.name().contains(text.as_str()))
    };
    if !bases.kinds().iter().copied().any(chosen) {
        return Err(NoTrouble(
            bases.kinds().iter().map(|kind| kind.name()).collect(),
        ));
    }
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let all = (first..).filter(|number| chosen(bases.trouble(*number)));
    Ok(all.take(count).collect())
}

/// Most runs of a campaign: all their numbers are kept, 0.8 GB.
pub const MAX_RUNS: u64 = 100_000_000;
/// Largest number of a first run: numbers of runs stay exact in JSON.
pub const MAX_FIRST: u64 = 1 << 52;

/// The campaign of a seed, as far as the command line and other front ends settle it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Campaign {
    /// Number of runs.
    pub runs: u64,
    /// Of everything that is drawn.
    pub seed: u64,
    /// Words in names of troubles; none for all troubles.
    pub only: Vec<String>,
    /// Bases with a gyro.
    pub gyro: bool,
    /// The first run.
    pub first: u64,
}

/// Why a campaign does not run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CampaignError {
    /// See [`NoTrouble`].
    #[error(transparent)]
    NoTrouble(#[from] NoTrouble),
    /// More runs, or a larger number of the first one, than may be.
    #[error("{what} must be at most {most}")]
    Limit {
        /// As an argument in programs.
        key: &'static str,
        /// In words.
        what: &'static str,
        /// The limit.
        most: u64,
    },
    /// A built-in base that cannot be read.
    #[error(transparent)]
    Base(#[from] ScenarioError),
    /// A world out of range.
    #[error(transparent)]
    World(#[from] ClosedLoopError),
}

impl Campaign {
    /// Its bases, and the numbers of its runs.
    ///
    /// # Errors
    /// Words that no trouble has, a number above its limit.
    pub fn numbers(&self) -> Result<(Bases, Vec<u64>), CampaignError> {
        let limits = [
            ("runs", "runs", self.runs, MAX_RUNS),
            (
                "first",
                "the number of the first run",
                self.first,
                MAX_FIRST,
            ),
        ];
        for (key, what, number, most) in limits {
            if number > most {
                return Err(CampaignError::Limit { key, what, most });
            }
        }
        let bases = match self.gyro {
            true => Bases::with_gyro(),
            false => Bases::built_in(),
        }?;
        let numbers = numbers(&bases, self.first, self.runs, &self.only)?;
        Ok((bases, numbers))
    }
}

impl Study for Campaign {
    const COMMAND: &'static str = "faults";
    type Run = RunOutcome;
    type Error = CampaignError;

    fn name(&self) -> String {
        Self::COMMAND.to_owned()
    }

    fn arguments(&self) -> Vec<String> {
        let mut words = vec!["--runs".to_owned(), self.runs.to_string()];
        words.extend(["--seed".to_owned(), self.seed.to_string()]);
        for word in &self.only {
            words.extend(["--only".to_owned(), word.clone()]);
        }
        words.extend(self.gyro.then(|| "--gyro".to_owned()));
        words
    }

    fn built_in(&self) -> Vec<&'static str> {
        let bases = BASES.iter().map(|base| base.text);
        bases.chain(self.gyro.then_some(GYRO)).collect()
    }

    fn count(&self) -> Result<usize, CampaignError> {
        Ok(self.numbers()?.1.len())
    }

    fn runs(
        &self,
        places: Range<usize>,
        tick: &(dyn Fn() + Sync),
    ) -> Result<Vec<RunOutcome>, CampaignError> {
        let (bases, numbers) = self.numbers()?;
        let numbers = numbers.get(places).unwrap_or_default().to_vec();
        Ok(study(&bases, self.seed, numbers, &Mutation::None, tick)?)
    }

    fn sheet(&self, _: usize, runs: &[RunOutcome]) -> Result<Sheet, CampaignError> {
        Ok(run_sheet(runs))
    }
}

/// Runs of the campaign of `seed`, in order. `done` is called after each.
///
/// A run is settled by seed and number alone: nothing depends on the number of threads, which is rayon's. A
/// panic is a violation of its run.
///
/// # Errors
/// See [`fn@run`].
pub fn study(
    bases: &Bases,
    seed: u64,
    runs: impl IntoParallelIterator<Item = u64>,
    mutation: &Mutation,
    done: impl Fn() + Sync,
) -> Result<Vec<RunOutcome>, ClosedLoopError> {
    let one = |number| {
        let plan = Plan::draw(bases, seed, number);
        let outcome = catch_unwind(AssertUnwindSafe(|| run(bases, &plan, mutation, |_| {})));
        done();
        outcome.unwrap_or_else(|panic| {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied());
            Ok(RunOutcome {
                end: Err(Violation {
                    at_s: 0.0,
                    what: format!("panic: {}", text.unwrap_or("without a text")),
                }),
                ..RunOutcome::begin(&plan)
            })
        })
    };
    runs.into_par_iter().map(one).collect()
}
