//! A verification by its settings, whole or in parts.

use super::csv::run_sheet;
use super::study::{Run, VerifyError, runs, runs_at};
use crate::csv_out::Sheet;
use crate::job::RobotFile;
use crate::part::Study;
use serde::{Deserialize, Serialize};
use std::num::NonZeroU32;
use std::ops::Range;
use std::path::PathBuf;

/// The verification of a robot's file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct VerifyStudy {
    /// Of a robot.
    pub robot: RobotFile,
    /// Where that was read, which says nothing of the study.
    #[serde(skip)]
    pub path: PathBuf,
    /// Worlds that are drawn for each course and condition.
    pub seeds: NonZeroU32,
    /// The first seed.
    pub seed: u64,
}

impl Study for VerifyStudy {
    const COMMAND: &'static str = "verify";
    type Run = Run;
    type Error = VerifyError;

    fn name(&self) -> String {
        format!("{}-verify", self.robot.name)
    }

    fn arguments(&self) -> Vec<String> {
        let (seeds, seed) = (self.seeds.to_string(), self.seed.to_string());
        let path = self.path.to_string_lossy();
        [&path, "--seeds", &seeds, "--seed", &seed]
            .map(str::to_owned)
            .to_vec()
    }

    fn built_in(&self) -> Vec<&'static str> {
        Vec::new()
    }

    fn count(&self) -> Result<usize, VerifyError> {
        Ok(usize::try_from(runs(self.seeds)).unwrap_or(usize::MAX))
    }

    fn runs(
        &self,
        places: Range<usize>,
        tick: &(dyn Fn() + Sync),
    ) -> Result<Vec<Run>, VerifyError> {
        runs_at(&self.robot.base, self.seed, self.seeds, places, tick)
    }

    fn sheet(&self, _: usize, runs: &[Run]) -> Result<Sheet, VerifyError> {
        Ok(run_sheet(runs))
    }
}
