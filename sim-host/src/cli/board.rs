//! Arguments for chips and boards.

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
    /// Bits per second of a serial port
    #[arg(long, value_name = "N", default_value = "115200")]
    pub baud: u32,
    /// Stop after so many seconds
    #[arg(long, value_name = "S")]
    pub seconds: Option<f64>,
    /// Ask for the board's own counters once a second. To the board this is a host that lives!
    #[arg(long)]
    pub poll: bool,
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
