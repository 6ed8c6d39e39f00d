//! Linear loops: when one grows, and how far it is from that.

mod feedback;
mod polynomial;

pub(crate) use feedback::Feedback;
pub use feedback::{LARGEST_FACTOR, LoopMargins};
pub(crate) use polynomial::{Polynomial, edge};
