//! Logs that other people's tools read: MCAP for those of ROS 2, WPILOG for AdvantageScope.
//!
//! [`DataLog`] writes a [`Sample`] and the fields of a row with each tick, as the run goes: what is in a file up to its last
//! chunk stays readable whatever becomes of the program. Bags are read by [`crate::ros`].
//!
//! `docs/logs.md` lists topics, entries and figures.

mod background;
mod bag;
pub mod messages;
mod sample;
mod wpilog;

pub use background::{Pending, logged};
pub use sample::{Level, Sample, Status};

use crate::csv_out::Cell;
use bag::Bag;
use std::fs::File;
use std::path::{Path, PathBuf};
use wpilog::Wpilog;

/// Whose fields a row has: the name of their message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A law of the paper.
    Paper,
    /// The default law.
    Motion,
    /// A real board.
    Board,
    /// A run of the fault campaign.
    Campaign,
}

impl From<crate::csv_out::Columns> for Source {
    fn from(columns: crate::csv_out::Columns) -> Self {
        match columns {
            crate::csv_out::Columns::Paper => Self::Paper,
            crate::csv_out::Columns::Motion => Self::Motion,
        }
    }
}

/// What a log is of.
#[derive(Clone, Copy, Debug)]
pub struct About<'a> {
    /// Whose fields its rows have.
    pub source: Source,
    /// For the diagnostics.
    pub robot: &'a str,
    /// Times count from here \[s\].
    pub epoch_s: f64,
    /// Of bags: how often odometry, frames and joints are written \[Hz\], at each tick at most.
    pub rate_hz: f64,
}

/// How often bags have odometry, frames and joints, unless they are to have them more often \[Hz\]: enough to see a base
/// move, at half of the size. The fields of a row are there at each tick.
pub const RATE_HZ: f64 = 10.0;

/// Why there is no log, or no more of it.
#[derive(Debug, thiserror::Error)]
pub enum DataLogError {
    /// Neither `.mcap` nor `.wpilog`.
    #[error("{}: the name of a log ends in .mcap or .wpilog", .0.display())]
    Ending(PathBuf),
    /// The file cannot be written.
    #[error("{}: cannot be written: {cause}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
}

/// A file that grows with each tick.
pub struct DataLog {
    path: PathBuf,
    format: Format,
}

enum Format {
    Bag(Box<Bag<File>>),
    Wpilog(Wpilog<File>),
}

enum Kind {
    Bag,
    Wpilog,
}

fn kind(path: &Path) -> Result<Kind, DataLogError> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("mcap") => Ok(Kind::Bag),
        Some("wpilog") => Ok(Kind::Wpilog),
        _ => Err(DataLogError::Ending(path.to_owned())),
    }
}

/// Whether a log can be named so, for those who have to run something first.
///
/// # Errors
/// [`DataLogError::Ending`].
pub fn check_name(path: &Path) -> Result<(), DataLogError> {
    kind(path).map(|_| ())
}

/// The fields of a row, with the names of their columns.
pub type Fields = [(&'static str, Cell)];

impl DataLog {
    /// Begins a file, whose kind its ending says.
    ///
    /// # Errors
    /// Another ending, or a file that cannot be written.
    pub fn create(path: &Path, about: &About<'_>) -> Result<Self, DataLogError> {
        let failed = |cause: String| DataLogError::Write {
            path: path.to_owned(),
            cause,
        };
        let begin = || File::create(path).map_err(|error| failed(error.to_string()));
        let format = match kind(path)? {
            Kind::Bag => {
                let bag = Bag::new(begin()?, about);
                Format::Bag(Box::new(bag.map_err(|error| failed(error.to_string()))?))
            }
            Kind::Wpilog => {
                let log = Wpilog::new(begin()?, about.epoch_s);
                Format::Wpilog(log.map_err(|error| failed(error.to_string()))?)
            }
        };
        Ok(Self {
            path: path.to_owned(),
            format,
        })
    }

    /// Writes a tick.
    ///
    /// # Errors
    /// Those of the file.
    pub fn add(&mut self, sample: &Sample, fields: &Fields) -> Result<(), DataLogError> {
        match &mut self.format {
            Format::Bag(bag) => failed(&self.path, bag.add(sample, fields)),
            Format::Wpilog(log) => failed(&self.path, log.add(sample, fields)),
        }
    }

    /// Puts all ticks into the file, where they survive the end of the program.
    ///
    /// # Errors
    /// Those of the file.
    pub fn flush(&mut self) -> Result<(), DataLogError> {
        match &mut self.format {
            Format::Bag(bag) => failed(&self.path, bag.flush()),
            Format::Wpilog(log) => failed(&self.path, log.flush()),
        }
    }

    /// Writes what ends the file.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(self) -> Result<(), DataLogError> {
        match self.format {
            Format::Bag(bag) => failed(&self.path, bag.finish()),
            Format::Wpilog(mut log) => failed(&self.path, log.flush()),
        }
    }
}

fn failed<E: std::fmt::Display>(path: &Path, written: Result<(), E>) -> Result<(), DataLogError> {
    written.map_err(|error| DataLogError::Write {
        path: path.to_owned(),
        cause: error.to_string(),
    })
}
