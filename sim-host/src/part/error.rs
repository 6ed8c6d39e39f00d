//! What can be wrong with parts.

use super::Shard;
use parquet::errors::ParquetError;
use std::path::PathBuf;

/// Why a part could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The file.
    #[error(transparent)]
    File(#[from] std::io::Error),
    /// Its format.
    #[error(transparent)]
    Format(#[from] ParquetError),
    /// A run or the settings do not go into it.
    #[error("{0}")]
    Record(String),
}

/// Why a file is no part.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// It cannot be opened.
    #[error("cannot be read: {0}")]
    File(#[from] std::io::Error),
    /// It is not a whole Parquet file: its writer may have died.
    #[error("cannot be read: {0}")]
    Format(#[from] ParquetError),
    /// It is a Parquet file of somebody else's.
    #[error("is no part of a study")]
    Foreign,
    /// What it says of itself cannot be understood.
    #[error("says of itself what this version does not understand: {0}")]
    Header(serde_json::Error),
    /// What it says of itself, or its runs.
    #[error("is not as it was written")]
    Damaged,
}

/// Why parts do not make a whole.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There is nothing that tells of a study.
    #[error("no part can be read:{}", lines(.0))]
    NoPart(Vec<(PathBuf, FileProblem)>),
    /// A file is of another study.
    #[error(
        "{} does not belong to {}: {what} is {} there, {} here",
        path.display(), first.display(), theirs, ours
    )]
    Stranger {
        /// The file.
        path: PathBuf,
        /// Another one.
        first: PathBuf,
        /// In what they differ.
        what: String,
        /// What `path` has.
        theirs: String,
        /// What `first` has.
        ours: String,
    },
    /// Made by a program that is not this one.
    #[error(
        "{}: made by another program: {what} is {theirs} there, {ours} here; merge with the program that made the parts",
        path.display()
    )]
    OtherProgram {
        /// The first of its parts.
        path: PathBuf,
        /// In what they differ.
        what: &'static str,
        /// What the part has.
        theirs: String,
        /// What this one has.
        ours: String,
    },
    /// The same part, twice, and not the same.
    #[error(
        "{} and {} are both part {shard} and differ", paths[0].display(), paths[1].display()
    )]
    Twice {
        /// Which part.
        shard: Shard,
        /// The files.
        paths: [PathBuf; 2],
    },
    /// Parts are missing.
    #[error("{}{}", missing_lines(.missing), lines(.broken))]
    Missing {
        /// Which, and the command that makes each.
        missing: Vec<(Shard, String)>,
        /// Files that cannot be read, which may be some of them.
        broken: Vec<(PathBuf, FileProblem)>,
    },
    /// A part is not as it was written.
    #[error("{}: {problem}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: FileProblem,
    },
    /// Settings that no study has.
    #[error("no such study: {0}")]
    Study(String),
}

fn lines(broken: &[(PathBuf, FileProblem)]) -> String {
    let line =
        |(path, problem): &(PathBuf, FileProblem)| format!("\n  {}: {problem}", path.display());
    broken.iter().map(line).collect()
}

fn missing_lines(missing: &[(Shard, String)]) -> String {
    let line = |(shard, command): &(Shard, String)| {
        let (number, count) = (shard.number(), shard.count());
        format!("part {number} of {count} is missing: run {command}")
    };
    let mut lines: Vec<_> = missing.iter().take(LISTED).map(line).collect();
    if let Some(more @ 1..) = missing.len().checked_sub(LISTED) {
        lines.push(format!("and {more} more are missing"));
    }
    lines.join("\n  ")
}

/// Missing parts that are listed, each with its command.
const LISTED: usize = 10;
