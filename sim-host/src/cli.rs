//! Arguments.

use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  sim-host                                  both cases of the paper, results in out/
  sim-host list                             what can be run by name
  sim-host show paper-curve > mine.toml     a commented file to start from
  sim-host run mine.toml --csv              figure, metrics and trace of your own scenario
  sim-host compare mine.toml                your scenario, neural beside plain
  sim-host compare weaving mine.toml        two scenarios beside each other";

/// Closed-loop simulation of a two-wheeled robot that follows a reference and parks.
///
/// Without a command: `paper`.
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXAMPLES, arg_required_else_help = false)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    output: Output,
}

/// Where and how results are written.
#[derive(Clone, Debug, Args)]
pub struct Output {
    /// Directory for results; made if it does not exist
    #[arg(long, global = true, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Write every N-th control tick to CSV files (the hand-over and the last one always)
    #[arg(long, global = true, value_name = "N", default_value = "1")]
    pub every: NonZeroUsize,
}

/// What to do.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Run both cases of the paper, neural and plain (the default)
    ///
    /// Prints a table and writes for each case a figure (.svg, .png) in the layout of the paper's
    /// Figs. 3 and 4, a CSV of every signal for both controllers, and the metrics as JSON.
    Paper,
    /// Run scenarios, each with the controller that it names
    ///
    /// Writes NAME.svg, NAME.png and NAME.json; NAME.csv with --csv.
    #[command(after_help = "\
Examples:
  sim-host run paper-line
  sim-host run scenarios/*.toml --out results --csv --every 10")]
    Run {
        /// Scenario files, or names from `sim-host list`
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// Write the trace of each run as CSV
        #[arg(long)]
        csv: bool,
    },
    /// Run one scenario with both laws, or several scenarios, and put them side by side
    ///
    /// With several files each runs with its own controller, and the first is compared with each
    /// of the others.
    #[command(after_help = "\
Examples:
  sim-host compare scenarios/paper-curve.toml
  sim-host compare standing-reference weaving --out results")]
    Compare {
        /// Scenario files, or names from `sim-host list`
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// Write the trace of each run as CSV
        #[arg(long)]
        csv: bool,
    },
    /// List scenarios with their descriptions
    List {
        /// A directory of scenario files instead of the built-in ones
        #[arg(value_name = "DIR")]
        directory: Option<PathBuf>,
    },
    /// Print a built-in scenario file, to start your own from
    Show {
        /// A name from `sim-host list`
        name: String,
    },
}

impl Cli {
    /// The command, `paper` if none was given.
    pub fn command(&self) -> &Command {
        self.command.as_ref().unwrap_or(&Command::Paper)
    }

    /// Where results go.
    pub fn output(&self) -> &Output {
        &self.output
    }
}
