//! What the tests share: the oracle, the golden traces, seeded states and the tolerances.

pub mod check;
pub mod golden;
pub mod oracle;
pub mod random;
pub mod tolerance;
