//! Arguments for chips and boards.

use crate::log_args::{LogArgs, positive};
use crate::seed_args::SeedArgs;
use clap::{Args, ValueEnum};
use firmware_demo::host::{LinkKind, Machine};
use std::path::PathBuf;

/// What to listen to.
#[derive(Clone, Debug, Args)]
pub struct MonitorArgs {
    /// A serial port, or the Unix socket of an emulator
    #[arg(value_name = "PORT")]
    pub port: PathBuf,
    /// Write every report to this file
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    #[command(flatten)]
    pub log: LogArgs,
    /// Bits per second of a serial port
    #[arg(long, value_name = "N", default_value = "115200")]
    pub baud: u32,
    /// Stop after so many seconds
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Ask for the board's own counters once a second. To the board this is a host that lives!
    #[arg(long)]
    pub poll: bool,
    /// Serve the page with what the board says, at this port of this machine only (0: a free one)
    #[arg(long, value_name = "PORT")]
    pub serve: Option<u16>,
    /// The page, as `cargo run -p page --bin page` makes it
    #[arg(long, value_name = "FILE", default_value = "target/page.html")]
    pub page: PathBuf,
}

/// What is driven by keys, and how fast.
#[derive(Clone, Debug, Args)]
pub struct TeleopArgs {
    /// The base, a file with [robot] and [limits] or one of paper-30kg, lab-10kg, hobby-1kg; else lab-10kg
    #[arg(long, value_name = "FILE")]
    pub base: Option<PathBuf>,
    /// A real base: its serial port, or the Unix socket of an emulator
    #[arg(long, value_name = "PORT")]
    pub port: Option<PathBuf>,
    /// Bits per second of a serial port
    #[arg(long, value_name = "N", default_value = "115200")]
    pub baud: u32,
    /// Speed at the end of ten steps [m/s]; else half of what the base can
    #[arg(long, value_name = "M/S", value_parser = positive)]
    pub speed: Option<f64>,
    /// Turn rate at the end of ten steps [rad/s]; else half of what the base can
    #[arg(long, value_name = "RAD/S", value_parser = positive)]
    pub turn_rate: Option<f64>,
    /// Hold the heading from the beginning
    #[arg(long)]
    pub hold_heading: bool,
    #[command(flatten)]
    pub seed: SeedArgs,
}

/// Control laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LawArg {
    /// The paper's, with shunting neurons
    Neural,
    /// The paper's backstepping without neurons
    Plain,
    /// The default law, for a real base
    Motion,
}

/// Emulated chips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Chip {
    /// Cortex-M4F, mps2-an386
    CortexM4f,
    /// riscv32imafc, virt
    Riscv32,
}

impl From<Chip> for Machine {
    fn from(chip: Chip) -> Self {
        match chip {
            Chip::CortexM4f => Self::CortexM4F,
            Chip::Riscv32 => Self::Riscv32,
        }
    }
}

/// Ways to a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Link {
    /// The emulated serial port
    Uart,
    /// Semihosting: fast
    Fifo,
}

impl From<Link> for LinkKind {
    fn from(link: Link) -> Self {
        match link {
            Link::Uart => Self::Uart,
            Link::Fifo => Self::Fifo,
        }
    }
}
