//! What a campaign runs on.

use super::plan::Bases;
use crate::job::RobotFile;
use crate::scenario::{BASES, GYRO, ScenarioError};
use std::path::PathBuf;

/// What a campaign runs on.
#[derive(Clone, Debug, PartialEq)]
pub enum Robots {
    /// The bases that are built in, in turn.
    BuiltIn,
    /// These with a gyro.
    BuiltInWithGyro,
    /// A robot of one's own, which has a gyro if its file has.
    Own {
        /// The robot.
        robot: Box<RobotFile>,
        /// Where it was read, which says nothing of the campaign.
        path: PathBuf,
    },
}

/// A gyro for built-in bases, and a robot.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("is of the built-in bases: a robot has a gyro if its file has")]
pub struct GyroOfRobot;

/// Of a robot whose file has no hardware.
const BARE: &str = "is missing: the campaign puts encoders, motor drivers, battery and poses out of order, and this file has no \
                    hardware; state [motor] and [battery], or [speed_driver], with [encoder] and [control]";

impl Robots {
    /// As arguments say it: a robot with the path of its file, and whether built-in bases have a gyro.
    ///
    /// # Errors
    /// Both.
    pub fn of(robot: Option<(RobotFile, PathBuf)>, gyro: bool) -> Result<Self, GyroOfRobot> {
        match (robot, gyro) {
            (Some(_), true) => Err(GyroOfRobot),
            (Some((robot, path)), false) => Ok(Self::Own {
                robot: Box::new(robot),
                path,
            }),
            (None, true) => Ok(Self::BuiltInWithGyro),
            (None, false) => Ok(Self::BuiltIn),
        }
    }

    /// The robot of one's own.
    pub fn own(&self) -> Option<&RobotFile> {
        match self {
            Self::Own { robot, .. } => Some(robot),
            Self::BuiltIn | Self::BuiltInWithGyro => None,
        }
    }

    /// What the campaign needs to know of them.
    ///
    /// # Errors
    /// A robot whose file has no hardware: what the campaign breaks is not there.
    pub(super) fn bases(&self) -> Result<Bases, ScenarioError> {
        match self {
            Self::BuiltIn => Bases::built_in(),
            Self::BuiltInWithGyro => Bases::with_gyro(),
            Self::Own { robot, .. } if robot.base.hardware.is_none() => Err(ScenarioError::of_key(
                &robot.file,
                &robot.text,
                "motor",
                BARE,
            )),
            Self::Own { robot, .. } => Ok(Bases::of_robot(robot)),
        }
    }

    /// The arguments that say so.
    pub fn arguments(&self) -> Vec<String> {
        match self {
            Self::BuiltIn => Vec::new(),
            Self::BuiltInWithGyro => vec!["--gyro".to_owned()],
            Self::Own { path, .. } => vec![path.to_string_lossy().into_owned()],
        }
    }

    /// Texts inside the program that they are read from; a robot's own is among the settings.
    pub(super) fn built_in(&self) -> Vec<&'static str> {
        let bases = BASES.iter().map(|base| base.text);
        match self {
            Self::BuiltIn => bases.collect(),
            Self::BuiltInWithGyro => bases.chain([GYRO]).collect(),
            Self::Own { .. } => Vec::new(),
        }
    }
}
