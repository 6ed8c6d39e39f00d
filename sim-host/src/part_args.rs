//! Studies in parts.

use crate::log_args::LogArgs;
use clap::Args;
use sim_host::part::Shard;
use std::path::PathBuf;

/// Which part of a study is run, and where its runs are kept.
#[derive(Clone, Debug, Args)]
pub struct PartArgs {
    /// Run part I of N only, counted from 1, into a file that `sim-host merge` puts together with the others
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Write a row for each run as Parquet; with --shard the part's file, else DIR/STUDY-part-I-of-N.parquet
    #[arg(long, value_name = "FILE")]
    pub parquet: Option<PathBuf>,
}

/// What is put together.
#[derive(Clone, Debug, Args)]
pub struct MergeArgs {
    /// All parts of one study, in any order
    #[arg(required = true, value_name = "PART.parquet")]
    pub parts: Vec<PathBuf>,
    /// Write all runs into one file, the one of --parquet without --shard
    #[arg(long, value_name = "FILE")]
    pub parquet: Option<PathBuf>,
    /// Of `tune`: write the gains into this robot's file, which has to be the one that was tuned
    #[arg(long, value_name = "ROBOT.toml")]
    pub write: Option<PathBuf>,
    // Of `faults` and `verify`: the log that the whole has.
    #[command(flatten)]
    pub log: LogArgs,
}
