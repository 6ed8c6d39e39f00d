//! A robot's file, for `tune`, `verify` and `constants`.

use super::error::CommandError;
use super::{note_named, warn_of_period};
use sim_host::job::RobotFile;
use std::path::Path;

/// A file if there is one, else a built-in base of that name. Says what its owner should change in it, and look at.
pub fn load(path: &Path) -> Result<RobotFile, CommandError> {
    let robot = RobotFile::load(path)?;
    note_named(&robot.base);
    warn_of_period(&robot.base.name, &robot.base, robot.base.period_s());
    Ok(robot)
}
