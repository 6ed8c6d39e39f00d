//! All runs, side by side.

use super::fault_injection::FaultInjectionKind;
use super::outcome::{RunOutcome, Violation};
use super::plan::{Bases, Plan};
use super::report::run_sheet;
use super::run::{Mutation, run};
use crate::closed_loop::ClosedLoopError;
use crate::csv_out::Sheet;
use crate::job::RobotFile;
use crate::part::Study;
use crate::scenario::{BASES, GYRO, ScenarioError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// All runs on this robot; else in turn on the bases that are built in.
    pub robot: Option<RobotFile>,
    /// Where that was read, which says nothing of the campaign.
    #[serde(skip)]
    pub path: PathBuf,
    /// Number of runs.
    pub runs: u64,
    /// Of everything that is drawn.
    pub seed: u64,
    /// Words in names of troubles; none for all troubles.
    pub only: Vec<String>,
    /// Built-in bases with a gyro; a robot of one's own has one if its file has.
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
    /// A base that cannot be read, or not be put to the campaign.
    #[error(transparent)]
    Base(#[from] ScenarioError),
    /// A world out of range.
    #[error(transparent)]
    World(#[from] ClosedLoopError),
}

/// Whether trouble can be made for a robot at all.
///
/// # Errors
/// One whose file has no hardware: what the campaign breaks is not there.
pub fn check(robot: &RobotFile) -> Result<(), ScenarioError> {
    if robot.base.hardware.is_some() {
        return Ok(());
    }
    let message = "is missing: the campaign puts encoders, motor drivers, battery and poses out of order, and this file has no \
                   hardware; state [motor] and [battery], or [speed_driver], with [encoder] and [control]";
    Err(ScenarioError::of_key(
        &robot.file,
        &robot.text,
        "motor",
        message,
    ))
}

impl Campaign {
    /// The bases that it runs on.
    ///
    /// # Errors
    /// See [`fn@check`].
    fn bases(&self) -> Result<Bases, ScenarioError> {
        match (&self.robot, self.gyro) {
            (Some(robot), _) => {
                check(robot)?;
                Ok(Bases::of_robot(robot))
            }
            (None, true) => Bases::with_gyro(),
            (None, false) => Bases::built_in(),
        }
    }

    /// The arguments that say on what bases it runs.
    pub fn on_what(&self) -> Vec<String> {
        match (&self.robot, self.gyro) {
            (Some(_), _) => vec![self.path.to_string_lossy().into_owned()],
            (None, true) => vec!["--gyro".to_owned()],
            (None, false) => Vec::new(),
        }
    }

    /// Its bases, and the numbers of its runs.
    ///
    /// # Errors
    /// Words that no trouble has, a number above its limit, a robot without hardware.
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
        let bases = self.bases()?;
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
        let robot = self.robot.as_ref();
        robot.map_or_else(|| Self::COMMAND.to_owned(), of)
    }

    fn arguments(&self) -> Vec<String> {
        let mut words = vec!["--runs".to_owned(), self.runs.to_string()];
        words.extend(["--seed".to_owned(), self.seed.to_string()]);
        for word in &self.only {
            words.extend(["--only".to_owned(), word.clone()]);
        }
        // After what may be given several times, which takes one word each.
        words.extend(self.on_what());
        words
    }

    fn made_by(&mut self, arguments: &[String]) {
        // The last of its own, as in `on_what`.
        if let (Some(_), Some(path)) = (&self.robot, arguments.last()) {
            self.path = path.into();
        }
    }

    fn built_in(&self) -> Vec<&'static str> {
        // A robot's own text is among the settings.
        if self.robot.is_some() {
            return Vec::new();
        }
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
                ..RunOutcome::begin(bases, &plan)
            })
        })
    };
    runs.into_par_iter().map(one).collect()
}
