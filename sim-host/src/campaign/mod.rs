//! The fault campaign: every state of the supervisor, every kind of trouble, at random times, by the thousand.
//!
//! A [`Plan`] is drawn from a seed and the number of a run: base, true plant, course, the state in which the
//! trouble strikes, the trouble and when it heals, and what the host does afterwards. [`fn@run`] drives the
//! chip's base of [`crate::rig`] through it and checks every tick:
//!
//! | always | |
//! | --- | --- |
//! | outputs | torques within their limit, duties within ±1, all numbers finite, no torque where nothing drives |
//! | order | no stop becomes milder, and none that latched is left, before the host says so |
//! | reaction | what is found in a live base has at least its reaction in the same tick |
//! | type | what is found fits the trouble; before the trouble nothing is found |
//! | time | what has to be found is found within the detector's time |
//! | way | from the tick in which a stop begins to rest it is within its bound |
//! | end | the base parks, waits as it was, or rests in Stopped or Fault |
//!
//! Runs end without a trace kept; [`study`] runs them side by side.

mod bounds;
mod check;
mod expected;
mod outcome;
mod path;
mod plan;
mod random;
mod report;
mod run;
mod study;
mod summary;
mod upset;

pub use outcome::{Detection, End, Outcome, Stop, Violation, Why};
pub use plan::{Bases, Plan, Target};
pub use report::{COLUMNS, Record, TRACE_COLUMNS, TraceWriter, table, violation, write_runs};
pub use run::{Mutation, Tick, run};
pub use study::study;
pub use summary::{Cell, CellRecord, cells};
pub use upset::{Upset, UpsetKind};
