//! What a board sends, for people and for a CSV file.
//!
//! [`Port`] is the line, [`Monitor`] decodes it, [`Log`] writes reports. Nothing is sent unless
//! [`Port::ask`] is called: to the board's watchdog a host that asks is a host that lives.

mod decode;
mod log;
#[cfg(not(target_family = "wasm"))]
mod port;

pub use decode::{LatestTelemetry, Monitor};
pub use log::{Log, column_names};
#[cfg(not(target_family = "wasm"))]
pub use port::{Port, Received};

use std::io;
use std::path::PathBuf;

/// Why the monitor ends.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// The port cannot be opened or set up.
    #[error("{}: cannot be opened: {cause}", path.display())]
    Open {
        /// The port.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// The line failed.
    #[error("the line failed: {0}")]
    Line(io::Error),
    /// The log cannot be written.
    #[error("{}: cannot be written: {cause}", path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
}
