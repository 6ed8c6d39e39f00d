//! Firmware library: protocol, control task and storage around `controller-core`.
//!
//! Every module but `board` builds on the host and on the chip alike; nothing here allocates, and in a
//! release image nothing can panic (the feature `panic-proof` turns a reachable panic into a link error).
#![no_std]

#[cfg(feature = "host")]
extern crate std;

pub mod control;
pub mod control_server;
pub mod drive;
pub mod excitation;
pub mod line;
pub mod mission;
pub mod model;
#[cfg(target_os = "none")]
mod panicked;
pub mod pil;
pub mod queue;
pub mod recorder;
#[cfg(feature = "robots")]
pub mod robots;
pub mod route;
pub mod storage;
pub mod telemetry;

#[cfg(target_os = "none")]
#[allow(unsafe_code)]
pub mod board;
#[cfg(target_os = "none")]
pub use panicked::panicked;

#[cfg(all(feature = "host", not(target_os = "none")))]
pub mod host;
