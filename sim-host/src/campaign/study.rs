//! All runs, side by side.

use super::fault_injection::FaultInjectionKind;
use super::outcome::{RunOutcome, Violation};
use super::plan::{Bases, Plan};
use super::report::run_sheet;
use super::robots::Robots;
use super::run::{Mutation, run};
use crate::closed_loop::ClosedLoopError;
use crate::csv_out::Sheet;
use crate::job::RobotFile;
use crate::part::Study;
use crate::scenario::ScenarioError;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

/// No kind of trouble has this word in its name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no trouble has `{word}` in its name; there are: {}", names.join("; "))]
pub struct NoTrouble {
    /// The word.
    pub word: String,
    /// All troubles; some have a comma in their name.
    pub names: Vec<&'static str>,
}

/// Numbers of `count` runs from `first` on, of troubles whose name has one of the words `only`; of all if there is none.
///
/// # Errors
/// A word that no trouble has.
fn numbers(bases: &Bases, first: u64, count: u64, only: &[String]) -> Result<Vec<u64>, NoTrouble> {
    let has = |kind: FaultInjectionKind, word: &String| kind.name().contains(word.as_str());
    let kinds = bases.kinds();
    if let Some(word) = only
        .iter()
        .find(|word| !kinds.iter().any(|kind| has(*kind, word)))
    {
        return Err(NoTrouble {
            word: word.clone(),
            names: kinds.iter().map(|kind| kind.name()).collect(),
        });
    }
    let chosen = |kind| only.is_empty() || only.iter().any(|word| has(kind, word));
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let all = (first..).filter(|number| chosen(bases.trouble(*number)));
    Ok(all.take(count).collect())
}

/// Most runs of a campaign: all their numbers are kept, 0.8 GB.
pub const MAX_RUNS: u64 = 100_000_000;
/// Largest number of a first run: numbers of runs stay exact in JSON.
pub const MAX_FIRST: u64 = 1 << 52;

/// The campaign of a seed, as far as the command line and other front ends settle it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Settings", into = "Settings")]
pub struct Campaign {
    /// What it runs on.
    pub on: Robots,
    /// Number of runs.
    pub runs: u64,
    /// Of everything that is drawn.
    pub seed: u64,
    /// Words in names of troubles; none for all troubles.
    pub only: Vec<String>,
    /// The first run.
    pub first: u64,
}

/// A campaign as files have it.
#[derive(Serialize, Deserialize)]
struct Settings {
    robot: Option<RobotFile>,
    runs: u64,
    seed: u64,
    only: Vec<String>,
    gyro: bool,
    first: u64,
}

impl From<Campaign> for Settings {
    fn from(campaign: Campaign) -> Self {
        Self {
            gyro: campaign.on == Robots::BuiltInWithGyro,
            robot: campaign.on.own().cloned(),
            runs: campaign.runs,
            seed: campaign.seed,
            only: campaign.only,
            first: campaign.first,
        }
    }
}

impl TryFrom<Settings> for Campaign {
    type Error = String;

    fn try_from(settings: Settings) -> Result<Self, String> {
        let robot = settings.robot.map(|robot| (robot, PathBuf::new()));
        Ok(Self {
            on: Robots::of(robot, settings.gyro).map_err(|e| format!("gyro {e}"))?,
            runs: settings.runs,
            seed: settings.seed,
            only: settings.only,
            first: settings.first,
        })
    }
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
    /// A base that cannot be read, or not be put to the campaign.
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
    /// A word that no trouble has, a number above its limit, a robot without hardware.
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
        let bases = self.on.bases()?;
        let numbers = numbers(&bases, self.first, self.runs, &self.only)?;
        Ok((bases, numbers))
    }
}

impl Study for Campaign {
    const COMMAND: &'static str = "faults";
    type Run = RunOutcome;
    type Error = CampaignError;

    fn name(&self) -> String {
        let of = |robot: &RobotFile| format!("{}-{}", robot.name, Self::COMMAND);
        let robot = self.on.own();
        robot.map_or_else(|| Self::COMMAND.to_owned(), of)
    }

    fn arguments(&self) -> Vec<String> {
        let mut words = vec!["--runs".to_owned(), self.runs.to_string()];
        words.extend(["--seed".to_owned(), self.seed.to_string()]);
        for word in &self.only {
            words.extend(["--only".to_owned(), word.clone()]);
        }
        // After what may be given several times, which takes one word each.
        words.extend(self.on.arguments());
        words
    }

    fn made_by(&mut self, arguments: &[String]) {
        // The last of its own, as in `arguments`.
        if let (Robots::Own { path, .. }, Some(last)) = (&mut self.on, arguments.last()) {
            *path = last.into();
        }
    }

    fn built_in(&self) -> Vec<&'static str> {
        self.on.built_in()
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
                ..RunOutcome::begin(bases, &plan)
            })
        })
    };
    runs.into_par_iter().map(one).collect()
}
