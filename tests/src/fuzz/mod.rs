//! Rubbish into everything that takes something from outside: files, the line, orders and measurements.
//!
//! A target runs on any bytes and asserts what has to hold for all of them; it says what it met, as numbers. The engine changes inputs
//! that met something new, beginning with real ones: no instrumented build is needed, and the same seed tries the same inputs on
//! every machine. `cargo test -p tests --test fuzz` tries so many; `cargo run --profile test -p tests --bin fuzz -- --minutes 10` as long as
//! one likes, and keeps what met something new, and what failed, in a folder.

pub mod base;
pub mod bytes;
pub mod engine;
pub mod files;
pub mod wire;

pub use engine::{Met, Outcome, Target, fuzz, inputs};

/// All targets.
pub const TARGETS: [Target; 5] = [
    files::TRAJECTORY,
    files::SCENARIO,
    files::BASE,
    wire::LINE,
    base::TICKS,
];
