//! On the emulated chips: what a tick costs, and that it computes what the host does; what a simulated tick costs there.

mod budgets;
mod host_cost;
mod parity;
