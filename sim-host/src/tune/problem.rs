//! What a base is tuned for.

use super::score::{Score, health};
use crate::closed_loop::ClosedLoopError;
use crate::drive::{FileError, FileRun};
use crate::import::TimeScaling;
use crate::mission::{BaseSpec, Course as Way, Mission};
use crate::trace::Trace;
use crate::trials::{self, Condition, Course, Figures};
use controller_core::motion::MotionGains;
use rayon::prelude::*;

/// Why gains are not rated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{mission}: {cause}")]
pub struct TuneError {
    mission: String,
    cause: ClosedLoopError,
}

/// Which worlds: those of the search and those of the test have no seed in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seeds {
    /// The search sees them.
    Training,
    /// It does not.
    Unseen,
}

impl Seeds {
    /// So many seeds of a search's own seed: even ones to train, odd ones to test.
    pub fn draw(self, seed: u64, count: usize) -> Vec<u64> {
        let odd = u64::from(self == Self::Unseen);
        let numbers = (0..count as u64).map(|k| 2 * k + odd);
        // Far from the small seeds that `verify` and scenarios use.
        let first = seed.wrapping_add(1).wrapping_shl(32);
        numbers.map(|k| first.wrapping_add(k)).collect()
    }
}

/// Missions, and the base that drives them.
#[derive(Clone, Debug)]
pub struct TuningProblem {
    missions: Vec<(Mission, Option<f64>)>,
    base: BaseSpec,
}

impl TuningProblem {
    /// The paper's line and curve and a park.
    pub fn courses(base: &BaseSpec) -> Self {
        let missions = Course::ALL
            .iter()
            .map(|course| with_end(course.mission(base)));
        Self {
            missions: missions.collect(),
            base: base.clone(),
        }
    }

    /// A trajectory file, and a park. Also how the time of the file was scaled.
    ///
    /// # Errors
    /// A file that cannot be driven.
    pub fn trajectory(
        base: &BaseSpec,
        name: &str,
        bytes: &[u8],
    ) -> Result<(Self, TimeScaling), FileError> {
        let run = FileRun {
            period_s: base.period_s(),
            ..FileRun::default()
        };
        let (mission, scaling) = run.mission(name, bytes, base)?;
        let missions = vec![with_end(mission), with_end(Course::Park.mission(base))];
        let base = base.clone();
        Ok((Self { missions, base }, scaling))
    }

    /// The base as it was given.
    pub fn base(&self) -> &BaseSpec {
        &self.base
    }

    /// Number of missions.
    pub fn missions(&self) -> usize {
        self.missions.len()
    }

    /// Gains in the worlds of these seeds, each mission in each.
    ///
    /// # Errors
    /// A base or a world out of range.
    pub fn score(&self, gains: &MotionGains<f64>, seeds: &[u64]) -> Result<Score, TuneError> {
        let runs: Vec<_> = (0..self.missions.len())
            .flat_map(|mission| seeds.iter().map(move |seed| (mission, *seed)))
            .collect();
        let runs = runs.into_par_iter().map(|(mission, seed)| {
            let end_s = self.missions.get(mission).and_then(|(_, end_s)| *end_s);
            let (_, figures) = self.run(mission, gains, seed)?;
            Ok(Score::of(&figures, end_s))
        });
        let runs: Vec<Score> = runs.collect::<Result<_, TuneError>>()?;
        Ok(Score::mean(&runs, health(gains, self.base.period_s())))
    }

    /// One run; a mission of a number that there is not is the first.
    ///
    /// # Errors
    /// As [`TuningProblem::score`].
    pub fn run(
        &self,
        mission: usize,
        gains: &MotionGains<f64>,
        seed: u64,
    ) -> Result<(Trace, Figures), TuneError> {
        let number = if mission < self.missions.len() {
            mission
        } else {
            0
        };
        let mut mission = self.missions[number].0.clone();
        mission.base.gains = Some(*gains);
        let setup = trials::setup(&self.base, Condition::Drawn, seed);
        trials::run(&mission, &setup).map_err(|cause| TuneError {
            mission: mission.name,
            cause,
        })
    }

    /// Name of a mission.
    pub fn name(&self, mission: usize) -> &str {
        let mission = self.missions.get(mission);
        mission.map_or("", |(mission, _)| mission.name.as_str())
    }
}

/// A mission and the time at which its route ends.
fn with_end(mission: Mission) -> (Mission, Option<f64>) {
    let end_s = match &mission.course {
        Way::Park(_) | Way::Drive => None,
        Way::Follow { hand_over, .. } => hand_over.map(|rule| rule.end_s),
    };
    (mission, end_s)
}
