//! Identification on simulated logs: what is stated is true, and what cannot be known is not stated.

mod coverage;
mod robot;
