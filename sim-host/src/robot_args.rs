//! Arguments for a robot of one's own.

use crate::count_args::{evaluations, seeds};
use crate::log_args::LogArgs;
use crate::part_args::PartArgs;
use crate::seed_args::SeedArgs;
use clap::Args;
use std::num::{NonZeroU32, NonZeroU64, NonZeroUsize};
use std::path::PathBuf;

/// What is tuned, and for what.
#[derive(Clone, Debug, Args)]
pub struct TuneArgs {
    /// The robot's file, as in bases/, or one of paper-30kg, lab-10kg, hobby-1kg
    #[arg(value_name = "ROBOT.toml")]
    pub robot: PathBuf,
    /// Tune for this trajectory instead of the paper's line and curve and a park
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Sets of gains that are tried, over all starts; each in a dozen worlds
    #[arg(long, value_name = "N", default_value = "240", value_parser = evaluations)]
    pub evaluations: NonZeroU64,
    /// Settles everything that is drawn
    #[arg(long, value_name = "N", default_value = "1")]
    pub seed: u64,
    /// Simplexes that share them, each from one of the best sets of a first look
    #[arg(long, value_name = "N", default_value = "3")]
    pub starts: NonZeroUsize,
    /// Write the gains into the robot's file
    #[arg(long)]
    pub write: bool,
    #[command(flatten)]
    pub part: PartArgs,
}

/// What is verified.
#[derive(Clone, Debug, Args)]
pub struct VerifyArgs {
    /// The robot's file, as in bases/, or one of paper-30kg, lab-10kg, hobby-1kg
    #[arg(value_name = "ROBOT.toml")]
    pub robot: PathBuf,
    /// Worlds that are drawn for each course and condition
    #[arg(long, value_name = "N", default_value = "10", value_parser = seeds)]
    pub seeds: NonZeroU32,
    #[command(flatten)]
    pub log: LogArgs,
    #[command(flatten)]
    pub seed: SeedArgs,
    #[command(flatten)]
    pub part: PartArgs,
}

/// What is written for a firmware.
#[derive(Clone, Debug, Args)]
pub struct ConstantsArgs {
    /// The robot's file, as in bases/, or one of paper-30kg, lab-10kg, hobby-1kg
    #[arg(value_name = "ROBOT.toml")]
    pub robot: PathBuf,
    /// A header for the C interface, NAME.h, instead of Rust
    #[arg(long)]
    pub c: bool,
}
