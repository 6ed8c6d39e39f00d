//! A robot's file, for whatever takes one.

use super::advise;
use super::error::CommandError;
use sim_host::advice::of_base;
use sim_host::job::RobotFile;
use std::path::Path;

/// A file if there is one, else a built-in base of that name. Says what its owner should change in it, and look at.
pub fn load(path: &Path) -> Result<RobotFile, CommandError> {
    let robot = RobotFile::load(path)?;
    advise(&of_base(&robot.base));
    Ok(robot)
}
