//! Identification on simulated logs: what is stated is true, and what cannot be known is not stated.

mod cli;
mod coverage;
mod limits;
mod robot;
mod structure;
