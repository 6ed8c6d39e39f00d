//! What a file on the command line is, by its content.

use super::error::CommandError;
use sim_host::drive::{FileRun, verdict};
use sim_host::import::{FileVerdict, TimeScaling};
use sim_host::mission::{BaseSpec, Mission};
use sim_host::scenario::{BuiltIn, Scenario};
use std::path::Path;

/// Something to run.
pub enum Job {
    /// With a controller of the paper.
    Scenario(Box<Scenario>),
    /// With the law for a real base.
    Mission {
        mission: Box<Mission>,
        /// The trajectory file that it follows, if it is no scenario.
        file: Option<Trajectory>,
    },
}

/// What became of a trajectory file.
pub struct Trajectory {
    pub scaling: TimeScaling,
    pub verdict: FileVerdict,
}

/// A file's content.
pub enum Content {
    /// A scenario, TOML.
    Scenario { file: String, text: String },
    /// Anything else is taken for a trajectory.
    Trajectory { name: String, bytes: Vec<u8> },
}

impl Job {
    /// A file if there is one, else a built-in scenario of that name.
    pub fn load(file: &Path, run: &FileRun, base: &BaseSpec) -> Result<Self, CommandError> {
        match Content::read(file)? {
            Content::Scenario { file, text } if Mission::is_motion(&text) => Ok(Self::Mission {
                mission: Box::new(Mission::parse(&file, &text)?),
                file: None,
            }),
            Content::Scenario { file, text } => {
                Ok(Self::Scenario(Box::new(Scenario::parse(&file, &text)?)))
            }
            Content::Trajectory { name, bytes } => {
                let failed = |cause| CommandError::Trajectory {
                    path: file.to_owned(),
                    cause,
                };
                let (mission, scaling) = run.mission(&name, &bytes, base).map_err(failed)?;
                let verdict = verdict(&bytes);
                Ok(Self::Mission {
                    mission: Box::new(mission),
                    file: Some(Trajectory { scaling, verdict }),
                })
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
    pub fn read(path: &Path) -> Result<Self, CommandError> {
        let file = path.display().to_string();
        let built_in = path.to_str().and_then(BuiltIn::find);
        if let Some(built_in) = built_in.filter(|_| !path.exists()) {
            let (file, text) = (format!("{}.toml", built_in.name), built_in.text.to_owned());
            return Ok(Self::Scenario { file, text });
        }
        let bytes = std::fs::read(path).map_err(|cause| CommandError::Read {
            path: path.to_owned(),
            cause,
        })?;
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

/// By the first line that says something; none if no line does.
///
/// TOML begins with `key = ` or `[table]`, where JSON has `{`, or `[` and then no name; the other
/// formats have neither.
fn looks_like_toml(text: &str) -> Option<bool> {
    let text = text.trim_start_matches('\u{feff}');
    let lines = text.lines().map(str::trim);
    let line = lines
        .into_iter()
        .find(|line| !line.is_empty() && !line.starts_with('#'))?;
    Some(match line.strip_prefix('[') {
        Some(rest) => rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '[' || c == '"'),
        None => line.contains('=') && !line.starts_with('{'),
    })
}
