//! Arguments of the benchmark.

use crate::seed_args::SeedArgs;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// What is compared.
#[derive(Clone, Debug, Args)]
pub struct BenchArgs {
    /// Bases: paper-30kg, lab-10kg, hobby-1kg; all of them without a name
    #[arg(value_name = "BASE")]
    pub bases: Vec<String>,
    /// Starts of parking, and worlds of each other track
    #[arg(long, value_name = "N", default_value = "40")]
    pub runs: NonZeroUsize,
    #[command(flatten)]
    pub seed: SeedArgs,
    /// Threads; the results do not depend on how many
    #[arg(long, value_name = "T")]
    pub threads: Option<NonZeroUsize>,
    /// Only classes whose name contains this, as `parking, ideal`; may be given several times
    #[arg(long, value_name = "TEXT")]
    pub only: Vec<String>,
    /// Only laws whose name contains this, beside the default law; may be given several times
    #[arg(long, value_name = "TEXT")]
    pub law: Vec<String>,
    /// A trajectory file more; may be given several times
    #[arg(long, value_name = "FILE")]
    pub file: Vec<PathBuf>,
    /// Six runs instead of --runs
    #[arg(long)]
    pub quick: bool,
    /// Search the rivals' gains anew, and write them to tuned.csv, before the comparison
    #[arg(long)]
    pub tune: bool,
}
