//! Why a command failed.

use sim_host::figure::FigureError;
use sim_host::run::RunError;
use sim_host::scenario::ScenarioError;
use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Figure(#[from] FigureError),
    #[error("{}: cannot be written: {cause}", path.display())]
    Write { path: PathBuf, cause: String },
    #[error("{}: cannot be listed: {cause}", path.display())]
    List {
        path: PathBuf,
        cause: std::io::Error,
    },
    #[error("two scenarios are named {0}: their results would overwrite each other")]
    SameName(String),
    #[error("no built-in scenario is named {0}: see `sim-host list`")]
    NoSuchName(String),
    #[error("cannot print: {0}")]
    Print(std::io::Error),
    #[error("the run has no ticks")]
    NoRows,
}
