//! The study by its settings, whole or in parts.

use super::closed_loop::Run;
use super::condition::Condition;
use super::study::{Place, places, run_all};
use super::{StudyError, catalogue, runs};
use crate::csv_out::{Column, Sheet, columns, sheet};
use crate::part::Study;
use crate::scenario::{BuiltIn, PAPER};
use serde::{Deserialize, Serialize};
use std::num::NonZeroU32;
use std::ops::Range;

/// What is studied.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Robustness {
    /// Runs of each condition with noise.
    pub seeds: NonZeroU32,
    /// Words in names of conditions; none for all conditions.
    pub only: Vec<String>,
}

impl Robustness {
    /// The conditions whose names contain one of the words; all without a word.
    ///
    /// # Errors
    /// A word that no condition has.
    pub fn conditions(&self) -> Result<Vec<Condition>, StudyError> {
        let mut conditions = catalogue();
        let has = |condition: &Condition, word: &String| condition.name.contains(word.as_str());
        if let Some(word) = self
            .only
            .iter()
            .find(|word| !conditions.iter().any(|c| has(c, word)))
        {
            return Err(StudyError::NoCondition {
                word: word.clone(),
                names: conditions.into_iter().map(|c| c.name).collect(),
            });
        }
        if !self.only.is_empty() {
            conditions.retain(|condition| self.only.iter().any(|word| has(condition, word)));
        }
        Ok(conditions)
    }
}

/// SI units, radians. Empty: not settled, not parked.
fn columns<'a, 'b>() -> [Column<&'a (Place<'b>, &'a Run)>; 15] {
    columns![row;
        "condition" => row.0.condition.name,
        "case" => row.0.case.name(),
        "law" => row.0.law.name(),
        "seed" => row.0.seed,
        "verdict" => row.1.verdict.name(),
        "settled" => row.1.settling_s,
        "parked" => row.1.parked_s,
        "final_position" => row.1.final_m,
        "final_heading" => row.1.final_rad,
        "following_force_std" => row.1.following_std.force,
        "following_moment_std" => row.1.following_std.moment,
        "rest_force_std" => row.1.rest_std.force,
        "rest_moment_std" => row.1.rest_std.moment,
        "peak_force" => row.1.peak_force_n,
        "peak_moment" => row.1.peak_moment_nm,
    ]
}

impl Study for Robustness {
    const COMMAND: &'static str = "robustness";
    type Run = Run;
    type Error = StudyError;

    fn name(&self) -> String {
        Self::COMMAND.to_owned()
    }

    fn arguments(&self) -> Vec<String> {
        let mut words = vec!["--seeds".to_owned(), self.seeds.to_string()];
        for word in &self.only {
            words.extend(["--only".to_owned(), word.clone()]);
        }
        words
    }

    fn built_in(&self) -> Vec<&'static str> {
        let cases = PAPER.iter().filter_map(|name| BuiltIn::find(name));
        cases.map(|case| case.text).collect()
    }

    fn count(&self) -> Result<usize, StudyError> {
        let count = runs(&self.conditions()?, self.seeds);
        Ok(usize::try_from(count).unwrap_or(usize::MAX))
    }

    fn runs(&self, part: Range<usize>, tick: &(dyn Fn() + Sync)) -> Result<Vec<Run>, StudyError> {
        let conditions = self.conditions()?;
        let all = places(&conditions, self.seeds);
        run_all(all.get(part).unwrap_or_default().to_vec(), tick)
    }

    fn sheet(&self, first: usize, runs: &[Run]) -> Result<Sheet, StudyError> {
        let conditions = self.conditions()?;
        let places = places(&conditions, self.seeds).into_iter().skip(first);
        let rows: Vec<_> = places.zip(runs).collect();
        Ok(sheet(&columns(), &rows))
    }
}
