//! On the emulated chips: what a tick costs, and that it computes what the host does.

mod budgets;
mod parity;
