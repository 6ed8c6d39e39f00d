//! A closed-loop simulator around `controller-core`.
//!
//! Scenario files go in, figures, tables and traces come out. The controller is the one that runs
//! on the chip, the same source called through a [`controller_port::ControllerPort`]; the [`plant`] is independent of
//! it and in double precision. Time is k times the control period, never a clock, so a scenario
//! gives the same numbers every time.
//!
//! | step | modules |
//! | --- | --- |
//! | read | [`scenario`], [`motion`], [`advice`], [`plausible`], [`job`] for any of them; a [`mission`] is what they ask of a base |
//! | whole base | [`closed_loop`] in a [`world`] |
//! | faults, by the thousand | [`campaign`] |
//! | run | [`plant`], [`world`], [`controller_port`], [`mod@run`], [`trace`]; [`drive`] for trajectory files |
//! | on a chip | [`pil`], [`monitor`] |
//! | from a robot's log | [`identify`] |
//! | for a robot of one's own | [`tune`], [`verify`], [`constants`]; [`trials`] on bad floors |
//! | studies in parts, on many machines | [`part`] |
//! | beside other laws | [`mod@bench`] |
//! | report | [`metrics`], [`table`], [`csv_out`], [`record`], [`plain_text`]; `figure` with the feature `figures`, `datalog` with that |
//!
//! In a browser (`wasm32`) there are neither ports and emulators nor studies and their tables.
//!
//! ```
//! use sim_host::metrics::Metrics;
//! use sim_host::scenario::BuiltIn;
//!
//! let scenario = BuiltIn::find("paper-line").ok_or("not built in")?.scenario()?;
//! let trace = sim_host::run::run(&scenario)?;
//! let metrics = Metrics::of(&trace).ok_or("no rows")?;
//! assert!((metrics.settling_s.ok_or("never settled")? - 4.98).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(
    target_family = "wasm",
    allow(dead_code, reason = "what only studies take")
)]

pub mod advice;
#[cfg(not(target_family = "wasm"))]
pub mod bench;
#[cfg(not(target_family = "wasm"))]
pub mod campaign;
pub mod closed_loop;
pub mod constants;
pub mod controller_port;
pub mod csv_out;
#[cfg(feature = "datalog")]
pub mod datalog;
pub mod drive;
#[cfg(feature = "figures")]
pub mod figure;
#[cfg(not(target_family = "wasm"))]
pub mod identify;
pub mod import;
pub mod job;
pub mod metrics;
pub mod mission;
pub mod monitor;
pub mod motion;
mod names;
mod numbers;
#[cfg(not(target_family = "wasm"))]
pub mod part;
#[cfg(not(target_family = "wasm"))]
pub mod pil;
pub mod plain_text;
pub mod plant;
pub mod plausible;
pub mod precision;
pub mod rate;
#[cfg(not(target_family = "wasm"))]
pub mod record;
#[cfg(not(target_family = "wasm"))]
pub mod robustness;
#[cfg(feature = "datalog")]
pub mod ros;
pub mod run;
pub mod scenario;
#[cfg(not(target_family = "wasm"))]
pub mod table;
pub mod teleop;
pub mod trace;
pub mod trials;
#[cfg(not(target_family = "wasm"))]
pub mod tune;
#[cfg(not(target_family = "wasm"))]
pub mod verify;
pub mod world;
