//! `list` and `show`.

use super::error::CommandError;
use super::say;
use sim_host::scenario::{BUILT_IN, BuiltIn, Scenario};
use std::path::{Path, PathBuf};

/// Names and descriptions, built in or of a directory.
pub fn list(directory: Option<&Path>) -> Result<(), CommandError> {
    let scenarios = match directory {
        None => {
            let built_in = BUILT_IN.iter().map(BuiltIn::scenario);
            built_in.collect::<Result<Vec<_>, _>>()?
        }
        Some(directory) => {
            let files = toml_files(directory)?;
            let loaded = files.iter().map(|file| Scenario::load(file));
            loaded.collect::<Result<Vec<_>, _>>()?
        }
    };
    let width = scenarios.iter().map(|s| s.name.chars().count()).max();
    let width = width.unwrap_or(0);
    for scenario in &scenarios {
        say(&format!(
            "{:width$}  {}\n",
            scenario.name, scenario.description
        ))?;
    }
    Ok(())
}

/// The text of a built-in file.
pub fn show(name: &str) -> Result<(), CommandError> {
    let missing = || CommandError::NoSuchName(name.to_owned());
    say(BuiltIn::find(name).ok_or_else(missing)?.text)
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
