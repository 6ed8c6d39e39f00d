//! Studies in parts: on any number of machines, in any order, with the bytes of one run of the whole.
//!
//! A [`Study`] is settled by its settings; each of its runs by these and its place. A [`Shard`] is a part of the places. Its
//! runs go into a Parquet file, with all that tells what they belong to: a row for each run, columns for other
//! programs, and in the column `record` the run as it is, bit for bit. [`Parts`] puts files together, or says which one
//! is missing, does not belong to the others or is not as it was written.

#[cfg(feature = "parts")]
mod error;
#[cfg(feature = "parts")]
mod file;
#[cfg(feature = "parts")]
mod merge;
mod shard;

#[cfg(feature = "parts")]
pub use error::{FileProblem, MergeError, WriteError};
#[cfg(feature = "parts")]
pub use file::write;
#[cfg(feature = "parts")]
pub use merge::{Parts, quoted};
pub use shard::{NoShard, Shard, shard};

use crate::csv_out::Sheet;
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::num::NonZeroU32;
use std::ops::Range;

/// Runs that are given to all threads together: a study that is to stop unwinds once for each piece that Rayon has split them into.
pub const AT_ONCE: usize = 16_384;

/// `one` of all places, in their order, by all threads together: what is collected of each piece of [`AT_ONCE`] places, one piece after the other.
pub fn in_pieces<T: Send, C: FromParallelIterator<T>>(
    places: Range<usize>,
    one: impl Fn(usize) -> T + Sync,
) -> impl Iterator<Item = C> {
    places.clone().step_by(AT_ONCE).map(move |from| {
        let piece = from..places.end.min(from.saturating_add(AT_ONCE));
        piece.into_par_iter().map(&one).collect()
    })
}

/// Most worlds of each case of a study: results of all are kept, some 0.4 GB.
pub const MAX_SEEDS: NonZeroU32 = NonZeroU32::new(100_000).unwrap();

/// A study whose runs can be made apart from each other.
pub trait Study: Serialize + DeserializeOwned {
    /// Its command.
    const COMMAND: &'static str;
    /// One run.
    type Run: Serialize + DeserializeOwned;
    /// Why there are no runs.
    type Error: std::error::Error;

    /// What its files are named after.
    fn name(&self) -> String;

    /// The command's arguments, which give the same settings again.
    fn arguments(&self) -> Vec<String>;

    /// Takes what of the arguments of a part the settings leave out, such as where a file was.
    fn made_by(&mut self, _arguments: &[String]) {}

    /// Texts inside the program that it reads, which another program may have otherwise.
    fn built_in(&self) -> Vec<&'static str>;

    /// Number of all runs.
    ///
    /// # Errors
    /// Settings that cannot be.
    fn count(&self) -> Result<usize, Self::Error>;

    /// How often these places tick.
    fn ticks(&self, places: &Range<usize>) -> u64 {
        places.len() as u64
    }

    /// The runs of these places, in order; on rayon's threads, whatever their number. `tick` is
    /// called for each, or for each part of it.
    ///
    /// # Errors
    /// Those of a run.
    fn runs(
        &self,
        places: Range<usize>,
        tick: &(dyn Fn() + Sync),
    ) -> Result<Vec<Self::Run>, Self::Error>;

    /// Runs from the place `first` on, column by column, for other programs.
    ///
    /// # Errors
    /// Settings that cannot be.
    fn sheet(&self, first: usize, runs: &[Self::Run]) -> Result<Sheet, Self::Error>;
}
