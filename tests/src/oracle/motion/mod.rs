//! The law for a real base, a second time: `docs/motion.md` as plain functions over vectors and numbers.
//!
//! Pairs are (along, around): speed and turn rate, force and moment. Sections are those of that page. Parking by manoeuvres is not
//! here: what a search finds is judged by what it leads to. Neither are refusals: every input is finite.

pub mod arrival;
pub mod command;
pub mod constants;
pub mod disturbance;
pub mod feedback;
pub mod follow;
pub mod law;
pub mod neuron;
pub mod velocity;

pub use constants::{Constants, Policy};
pub use law::{Inputs, Law, Row, Task};
pub use neuron::Rule;

/// Along the heading, and around the vertical.
pub type Pair = nalgebra::Vector2<f64>;
