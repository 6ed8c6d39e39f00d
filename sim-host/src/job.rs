//! What a user names to be run: a file, by its content, or what is built in, and the robot that runs it.

use crate::csv_out::Columns;
use crate::drive::{FileError, FileRun, trajectory};
use crate::import::{self, TimeScaling};
use crate::mission::{BaseSpec, Mission};
use crate::run::{self, RunError, Watch};
use crate::scenario::{self, BuiltIn, BuiltInBase, Scenario, ScenarioError, if_named};
use crate::trace::Trace;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Why there is nothing to run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// A scenario or a robot's file that cannot be used.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// No such file, or no right to it.
    #[error("{}: cannot be read: {cause}{}", path.display(), if_named(path, cause))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// A bag without poses that could be taken.
    #[cfg(feature = "datalog")]
    #[error("{}: {cause}", path.display())]
    Bag {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: crate::ros::read::ReadError,
    },
    /// A trajectory file that cannot be driven.
    #[error("{}: {cause}", path.display())]
    Trajectory {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: FileError,
    },
}

/// Something to run.
#[derive(Clone, Debug)]
pub enum Job {
    /// With a controller of the paper.
    Scenario(Box<Scenario>),
    /// With the law for a real base.
    Mission {
        /// What the robot is to do.
        mission: Box<Mission>,
        /// The trajectory file that it follows, if it is no scenario.
        file: Option<Trajectory>,
    },
}

/// What became of a trajectory file.
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// How its time was scaled for the base.
    pub scaling: TimeScaling,
    /// As it was read.
    pub read: Box<import::Trajectory>,
}

/// A file's content.
#[derive(Clone, Debug)]
pub enum Content {
    /// A scenario, TOML.
    Scenario {
        /// Its name for errors.
        file: String,
        /// What it says.
        text: String,
    },
    /// Anything else is taken for a trajectory.
    Trajectory {
        /// File name without its extension.
        name: String,
        /// What is in it.
        bytes: Vec<u8>,
    },
}

impl Job {
    /// A file if there is one, else a built-in scenario of that name. `run` and `base` are for trajectory files.
    ///
    /// # Errors
    /// What cannot be read, used or driven.
    pub fn load(file: &Path, run: &FileRun, base: &BaseSpec) -> Result<Self, JobError> {
        match Content::read(file)? {
            Content::Scenario { file, text } => Ok(Self::parse(&file, &text)?),
            Content::Trajectory { name, bytes } => {
                let job = Self::follow(&name, &bytes, run, base);
                job.map_err(|cause| JobError::Trajectory {
                    path: file.to_owned(),
                    cause,
                })
            }
        }
    }

    /// A scenario from its text; `file` is the name that errors show.
    ///
    /// # Errors
    /// As [`Scenario::parse`] and [`Mission::parse`].
    pub fn parse(file: &str, text: &str) -> Result<Self, ScenarioError> {
        Ok(if Mission::is_motion(text) {
            Self::Mission {
                mission: Box::new(Mission::parse(file, text)?),
                file: None,
            }
        } else {
            Self::Scenario(Box::new(Scenario::parse(file, text)?))
        })
    }

    /// A trajectory file from its content.
    ///
    /// # Errors
    /// As [`FileRun::mission`].
    pub fn follow(
        name: &str,
        bytes: &[u8],
        run: &FileRun,
        base: &BaseSpec,
    ) -> Result<Self, FileError> {
        let read = Box::new(trajectory(bytes, &run.retiming)?);
        let (mission, scaling) = run.along(name, &read, base)?;
        Ok(Self::Mission {
            mission: Box::new(mission),
            file: Some(Trajectory { scaling, read }),
        })
    }

    /// Runs it.
    ///
    /// # Errors
    /// The first fault of the controller, with its time; parameters out of their range.
    pub fn run(&self) -> Result<Trace, RunError> {
        self.run_watched(None)
    }

    /// As [`run`](Self::run), and `watch` sees every tick.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_watched(&self, watch: Watch<'_>) -> Result<Trace, RunError> {
        match self {
            Self::Scenario(scenario) => run::run_watched(scenario, watch),
            Self::Mission { mission, .. } => run::drive_watched(mission, watch),
        }
    }

    /// Columns of its trace.
    pub fn columns(&self) -> Columns {
        match self {
            Self::Scenario(_) => Columns::Paper,
            Self::Mission { .. } => Columns::Motion,
        }
    }

    /// Title of its figure. In figures an underscore begins a subscript.
    pub fn title(&self) -> String {
        match self {
            Self::Scenario(scenario) => format!("{}: {}", scenario.name, scenario.description),
            Self::Mission { mission, .. } => {
                format!(
                    "{}: {}",
                    mission.name.replace('_', " "),
                    mission.description
                )
            }
        }
    }

    /// With a controller of the paper.
    pub fn scenario(&self) -> Option<&Scenario> {
        match self {
            Self::Scenario(scenario) => Some(scenario),
            Self::Mission { .. } => None,
        }
    }

    /// The name that results get.
    pub fn name(&self) -> &str {
        match self {
            Self::Scenario(scenario) => &scenario.name,
            Self::Mission { mission, .. } => &mission.name,
        }
    }
}

impl Content {
    /// Reads a file, or takes a built-in scenario of that name.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(path: &Path) -> Result<Self, JobError> {
        let file = path.display().to_string();
        if let Some(built_in) = BuiltIn::at(path) {
            let (file, text) = (format!("{}.toml", built_in.name), built_in.text.to_owned());
            return Ok(Self::Scenario { file, text });
        }
        #[cfg(feature = "datalog")]
        let (path, topic) = &of_bag(path);
        // Once, for a pipe has nothing the second time.
        let bytes = std::fs::read(path).map_err(|cause| JobError::Read {
            path: path.to_owned(),
            cause,
        })?;
        #[cfg(feature = "datalog")]
        if crate::ros::read::is_bag(&bytes) {
            return Self::bag(path, &bytes, topic.as_deref());
        }
        let named_toml = path
            .extension()
            .is_some_and(|extension| extension == "toml");
        let stem = path.file_stem().unwrap_or_default();
        let name = stem.to_string_lossy().into_owned();
        match String::from_utf8(bytes) {
            Ok(text) if looks_like_toml(&text).unwrap_or(named_toml) => {
                Ok(Self::Scenario { file, text })
            }
            Ok(text) => Ok(Self::Trajectory {
                name,
                bytes: text.into_bytes(),
            }),
            Err(error) => Ok(Self::Trajectory {
                name,
                bytes: error.into_bytes(),
            }),
        }
    }
}

#[cfg(feature = "datalog")]
impl Content {
    /// The poses of a bag.
    fn bag(path: &Path, bytes: &[u8], topic: Option<&str>) -> Result<Self, JobError> {
        let text = import::bag_poses(bytes, topic);
        let text = text.map_err(|cause| JobError::Bag {
            path: path.to_owned(),
            cause,
        })?;
        let stem = path.file_stem().unwrap_or_default();
        Ok(Self::Trajectory {
            name: stem.to_string_lossy().into_owned(),
            bytes: text.into_bytes(),
        })
    }
}

/// The file and the topic of `BAG.mcap:/topic`, unless there is a file of that very name.
#[cfg(feature = "datalog")]
fn of_bag(path: &Path) -> (PathBuf, Option<String>) {
    let whole = path.to_string_lossy();
    match whole.split_once(".mcap:").filter(|_| !path.exists()) {
        Some((stem, topic)) => (
            PathBuf::from(format!("{stem}.mcap")),
            Some(topic.to_owned()),
        ),
        None => (path.to_owned(), None),
    }
}

/// By the first line that says something; none if no line does.
///
/// TOML begins with `key = `, `[table]` or `[[table]]`, where JSON has `{`, or brackets and then no name; the other
/// formats have neither.
fn looks_like_toml(text: &str) -> Option<bool> {
    let text = text.trim_start_matches('\u{feff}');
    let line = text.lines().find(|line| !import::says_nothing(line))?;
    let line = line.trim();
    Some(match line.strip_prefix('[') {
        Some(rest) => {
            let name = rest.strip_prefix('[').unwrap_or(rest);
            name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '"')
        }
        None => line.contains('=') && !line.starts_with('{'),
    })
}

/// A robot with the text that describes it. Its serialised form is the text with its names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RobotText", into = "RobotText")]
pub struct RobotFile {
    /// File name without its extension.
    pub name: String,
    /// File name.
    pub file: String,
    /// The file.
    pub text: String,
    /// What it says.
    pub base: BaseSpec,
}

impl RobotFile {
    /// A file if there is one, else a built-in base of that name.
    ///
    /// # Errors
    /// A file that cannot be read or used.
    pub fn load(path: &Path) -> Result<Self, JobError> {
        let part = |part: Option<&std::ffi::OsStr>| {
            part.map_or_else(String::new, |part| part.to_string_lossy().into_owned())
        };
        if let Some(built_in) = BuiltInBase::at(path) {
            return Ok(Self {
                name: built_in.name.to_owned(),
                file: format!("{}.toml", built_in.name),
                text: built_in.text.to_owned(),
                base: built_in.base()?,
            });
        }
        let bytes = std::fs::read(path).map_err(|cause| JobError::Read {
            path: path.to_owned(),
            cause,
        })?;
        let text = scenario::text(&path.display().to_string(), bytes)?;
        Ok(Self {
            name: part(path.file_stem()),
            file: part(path.file_name()),
            base: BaseSpec::parse(&path.display().to_string(), &text)?,
            text,
        })
    }
}

/// What a robot is read from.
#[derive(Serialize, Deserialize)]
struct RobotText {
    name: String,
    file: String,
    text: String,
}

impl From<RobotFile> for RobotText {
    fn from(robot: RobotFile) -> Self {
        Self {
            name: robot.name,
            file: robot.file,
            text: robot.text,
        }
    }
}

impl TryFrom<RobotText> for RobotFile {
    type Error = ScenarioError;

    fn try_from(robot: RobotText) -> Result<Self, ScenarioError> {
        Ok(Self {
            base: BaseSpec::parse(&robot.file, &robot.text)?,
            name: robot.name,
            file: robot.file,
            text: robot.text,
        })
    }
}
