//! Gains for a robot of one's own, searched on bad floors.
//!
//! [`TuningProblem::score`] rates gains by what happens ([`Score`] has the parts with their units and weights),
//! [`search`] looks for better ones: Nelder and Mead's simplex over the logarithms of [`KNOBS`], from
//! several starts side by side. Worlds of the search and of the test are drawn by different seeds.
//! Nothing depends on the number of threads.

mod knobs;
mod part;
mod problem;
mod profile;
mod score;
mod search;
pub(crate) mod simplex;
mod table;

pub use knobs::{KNOBS, Knob};
pub use part::{TrajectoryText, TuneStudy, TuneStudyError};
pub use problem::{Seeds, TuneError, TuningProblem};
pub use profile::update;
pub use score::{POSE_DELAY_S, Score, health, torque_delay_s};
pub use search::{Find, MAX_EVALUATIONS, Search, Tuned, conclude, finds, search};
pub use table::report;

use crate::job::RobotFile;
use crate::scenario::ScenarioError;
use crate::trials;

/// Whether there is anything to search for.
///
/// # Errors
/// A robot that learns from nothing outside where it is, as in [`crate::verify::check`].
pub fn check(robot: &RobotFile) -> Result<(), ScenarioError> {
    let asked = "a run gets points for how far from the true goal it ends";
    trials::check_poses(robot, asked)
}
