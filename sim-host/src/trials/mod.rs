//! Trials of a base on bad floors: what [`crate::tune`] searches with and [`crate::verify`] judges by.
//!
//! A trial is a [`Course`] in a world of a [`Condition`], drawn by a seed, with the chip's whole base
//! in it ([`crate::closed_loop`]); [`Figures`] say what came of it.

mod course;
mod figures;
mod floor;

pub use course::Course;
pub use figures::{Figures, Peak, REST_S};
pub use floor::{Condition, setup};

use crate::closed_loop::ClosedLoopError;
use crate::job::RobotFile;
use crate::mission::Mission;
use crate::run::{Watch, drive_and_observe_watched};
use crate::scenario::ScenarioError;
use crate::trace::Trace;
use crate::world::WorldSetup;

/// Largest true distance to the goal at the end \[m\].
pub const DISTANCE_M: f64 = 5.0e-3;
/// Largest true heading error at the end \[rad\].
pub const HEADING_RAD: f64 = 10.0e-3;

/// Runs a mission in a world and observes the base at rest for [`REST_S`].
///
/// # Errors
/// Parameters out of their range.
pub fn run(mission: &Mission, setup: &WorldSetup) -> Result<(Trace, Figures), ClosedLoopError> {
    run_watched(mission, setup, None)
}

/// As [`run`], and `watch` sees every tick.
///
/// # Errors
/// As [`run`].
pub fn run_watched(
    mission: &Mission,
    setup: &WorldSetup,
    watch: Watch<'_>,
) -> Result<(Trace, Figures), ClosedLoopError> {
    let trace = drive_and_observe_watched(mission, setup, REST_S, watch)?;
    let figures = Figures::of(mission, &trace);
    Ok((trace, figures))
}

/// Whether a robot learns from anything outside where it is; `asked` is what of the truth decides about a run.
pub(crate) fn check_poses(robot: &RobotFile, asked: &str) -> Result<(), ScenarioError> {
    let hardware = robot.base.hardware.as_ref();
    if hardware.is_some_and(|hardware| hardware.pose_source.is_some()) {
        return Ok(());
    }
    let message = format!(
        "is missing: {asked}, and encoders alone do not tell a base where that is, whatever its gains are. Append \
         [pose_source] with rate_hz, latency_s, noise_m and noise_rad of its localisation; bases/lab-10kg.toml has \
         those of a camera. A robot that has none is tested by `faults ROBOT.toml`, and its gains follow from [limits]"
    );
    let (file, text) = (&robot.file, &robot.text);
    Err(ScenarioError::of_key(file, text, "pose_source", &message))
}
