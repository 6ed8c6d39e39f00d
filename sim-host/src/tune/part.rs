//! A search by its settings, whole or in parts.

use super::knobs::{KNOBS, gains};
use super::problem::{TuneError, TuningProblem};
use super::search::{Find, Search, finds};
use crate::csv_out::{Cell, Kind, Sheet};
use crate::drive::FileError;
use crate::import::TimeScaling;
use crate::job::RobotFile;
use crate::part::Study;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::PathBuf;

/// The search of a robot's gains.
///
/// Its runs are what the first look and each start ended with. A simplex takes one step after the other, so a start cannot be
/// divided; every part makes the whole look, which tells where the starts are.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TuneStudy {
    /// Of a robot.
    pub robot: RobotFile,
    /// Where that was read, which says nothing of the search.
    #[serde(skip)]
    pub path: PathBuf,
    /// What to tune for instead of the paper's line and curve and a park.
    pub trajectory: Option<TrajectoryText>,
    /// Sets of gains that are tried, over all starts.
    pub evaluations: u64,
    /// Simplexes.
    pub starts: usize,
    /// Settles everything that is drawn.
    pub seed: u64,
}

/// A trajectory file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TrajectoryText {
    /// Its name without an extension.
    pub name: String,
    /// Where it was read.
    #[serde(skip)]
    pub path: PathBuf,
    /// What it says.
    #[serde(with = "text")]
    pub bytes: Vec<u8>,
}

/// Files that can be driven are text.
mod text {
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(bytes: &[u8], to: S) -> Result<S::Ok, S::Error> {
        let text = std::str::from_utf8(bytes).map_err(S::Error::custom)?;
        text.serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u8>, D::Error> {
        String::deserialize(from).map(String::into_bytes)
    }
}

/// Why there is no search.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuneStudyError {
    /// A trajectory file that cannot be driven.
    #[error("{}: {cause}", path.display())]
    Trajectory {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: FileError,
    },
    /// A base or a world out of range.
    #[error(transparent)]
    Tune(#[from] TuneError),
}

impl TuneStudy {
    /// How much is searched.
    pub fn search(&self) -> Search {
        Search {
            evaluations: self.evaluations,
            starts: self.starts,
            seed: self.seed,
            ..Search::default()
        }
    }

    /// What the robot is tuned for, and how the time of the trajectory was scaled, if there is one.
    ///
    /// # Errors
    /// A trajectory that cannot be driven.
    pub fn problem(&self) -> Result<(TuningProblem, Option<TimeScaling>), TuneStudyError> {
        let base = &self.robot.base;
        let Some(TrajectoryText { name, path, bytes }) = &self.trajectory else {
            return Ok((TuningProblem::courses(base), None));
        };
        let problem = TuningProblem::trajectory(base, name, bytes);
        let (problem, scaling) = problem.map_err(|cause| TuneStudyError::Trajectory {
            path: path.clone(),
            cause,
        })?;
        Ok((problem, Some(scaling)))
    }
}

impl Study for TuneStudy {
    const COMMAND: &'static str = "tune";
    type Run = Find;
    type Error = TuneStudyError;

    fn name(&self) -> String {
        format!("{}-tune", self.robot.name)
    }

    fn arguments(&self) -> Vec<String> {
        let mut words = vec![self.path.to_string_lossy().into_owned()];
        if let Some(trajectory) = &self.trajectory {
            let path = trajectory.path.to_string_lossy().into_owned();
            words.extend(["--trajectory".to_owned(), path]);
        }
        for (name, value) in [
            ("--evaluations", self.evaluations),
            ("--starts", self.starts as u64),
            ("--seed", self.seed),
        ] {
            words.extend([name.to_owned(), value.to_string()]);
        }
        words
    }

    fn built_in(&self) -> Vec<&'static str> {
        Vec::new()
    }

    fn count(&self) -> Result<usize, TuneStudyError> {
        Ok(self.search().finds())
    }

    fn ticks(&self, places: &Range<usize>) -> u64 {
        self.search().trials(places)
    }

    fn runs(
        &self,
        places: Range<usize>,
        tick: &(dyn Fn() + Sync),
    ) -> Result<Vec<Find>, TuneStudyError> {
        let (problem, _) = self.problem()?;
        Ok(finds(&problem, &self.search(), places, tick)?)
    }

    /// * start: 0 is the best of the first look, then the starts from 1 on.
    /// * points: in the worlds of the search; the gains by their keys.
    fn sheet(&self, first: usize, finds: &[Find]) -> Result<Sheet, TuneStudyError> {
        let plain = self.robot.base.motion().gains;
        let starts = (first..).take(finds.len());
        let number = |value: Option<f64>| value.map_or(Cell::Nothing(Kind::Number), Cell::Number);
        let points = finds
            .iter()
            .map(|find| find.as_ref().map(|(cost, _)| *cost));
        let mut sheet = vec![
            (
                "start",
                starts.map(|start| Cell::Whole(start as u64)).collect(),
            ),
            ("points", points.map(number).collect()),
        ];
        for knob in KNOBS {
            let value = |find: &Find| {
                let found = find.as_ref();
                number(found.map(|(_, logs)| knob.of(&gains(&plain, logs))))
            };
            sheet.push((knob.key, finds.iter().map(value).collect()));
        }
        Ok(sheet)
    }
}
