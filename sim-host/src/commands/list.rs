//! `list` and `show`.

use super::error::CommandError;
use super::{say, tell};
use sim_host::mission::Mission;
use sim_host::plain_text::written_out;
use sim_host::scenario::{BUILT_IN, MISSIONS, Scenario, ScenarioError};
use std::path::{Path, PathBuf};

/// Names and descriptions, built in or of a directory.
pub fn list(directory: Option<&Path>) -> Result<(), CommandError> {
    let mut failed = Vec::new();
    let scenarios = match directory {
        None => {
            let built_in = BUILT_IN.iter().chain(MISSIONS);
            let named = built_in.map(|b| described(&format!("{}.toml", b.name), b.text));
            named.collect::<Result<Vec<_>, _>>()?
        }
        Some(directory) => {
            let files = toml_files(directory)?;
            let all = files.iter().map(|file| load(file));
            all.filter_map(|scenario| scenario.map_err(|error| failed.push(error)).ok())
                .collect()
        }
    };
    let width = scenarios.iter().map(|(name, _)| name.chars().count()).max();
    let width = width.unwrap_or(0);
    for (name, description) in &scenarios {
        say(&written_out(&format!("{name:width$}  {description}\n")))?;
    }
    if let Some(directory) = directory.filter(|_| scenarios.is_empty() && failed.is_empty()) {
        let directory = directory.display();
        tell(&format!("note: {directory}: has no scenarios (*.toml)\n"));
    }
    CommandError::all(failed)
}

/// Name and description of a file.
fn load(file: &Path) -> Result<(String, String), CommandError> {
    match std::fs::read_to_string(file) {
        Ok(text) => Ok(described(&file.display().to_string(), &text)?),
        // Says what is wrong with it.
        Err(_) => Ok(Scenario::load(file).map(|s| (s.name, s.description))?),
    }
}

/// Name and description of a scenario, with either law.
fn described(file: &str, text: &str) -> Result<(String, String), ScenarioError> {
    if Mission::is_motion(text) {
        Mission::parse(file, text).map(|m| (m.name, m.description))
    } else {
        Scenario::parse(file, text).map(|s| (s.name, s.description))
    }
}

/// The text of a built-in file.
pub fn show(name: &str) -> Result<(), CommandError> {
    let missing = || CommandError::NoSuchName(name.to_owned());
    say(sim_host::scenario::BuiltIn::find(name)
        .ok_or_else(missing)?
        .text)
}

fn toml_files(directory: &Path) -> Result<Vec<PathBuf>, CommandError> {
    let failed = |cause| CommandError::List {
        path: directory.to_owned(),
        cause,
    };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
