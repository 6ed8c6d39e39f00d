//! What a board sends, for people, for a CSV file and for browsers.
//!
//! [`Port`] is the line, [`Monitor`] decodes it, [`Log`] writes reports, `BoardServer`
//! serves them with the page. Nothing is sent unless
//! [`Port::ask`] is called: to the board's watchdog a host that asks is a host that lives.

mod decode;
mod log;
#[cfg(not(target_family = "wasm"))]
mod port;
mod questions;
mod recording;
#[cfg(not(target_family = "wasm"))]
mod serve;

pub use decode::{LatestTelemetry, Monitor};
pub use log::{Log, column_names, report_fields};
pub use questions::{AHEAD_S, Questions, SAMPLE_S, stops};
pub use recording::{Lost, RecordedDrive};
#[cfg(not(target_family = "wasm"))]
pub use {
    port::{Port, Received},
    serve::BoardServer,
};

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
    /// The page cannot be served.
    #[error("port {port} of this machine: {cause}")]
    Serve {
        /// The port asked for.
        port: u16,
        /// Why.
        cause: String,
    },
    /// There is no page to serve.
    #[error("{}: {cause}: `cargo run -p page --bin page` makes it", path.display())]
    Page {
        /// Its file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// The line ended before it was asked to.
    #[error("{}: the line ended: the board is unplugged, or its emulator is gone", .0.display())]
    Ended(PathBuf),
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
