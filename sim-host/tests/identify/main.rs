//! Identification on simulated logs: what is stated is true, and what cannot be known is not stated.

mod bases;
mod cli;
mod coverage;
mod limits;
mod live;
mod plant;
mod profile;
#[path = "../program.rs"]
mod program;
mod robot;
mod round_trip;
mod structure;
mod tally;
mod world;
