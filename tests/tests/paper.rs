//! The paper's laws, its claims, and the core's mathematics; what the sources say of themselves.

mod continuity;
mod continuity_rates;
mod core_golden;
mod core_lyapunov;
mod derivation_figures;
mod geometry_properties;
mod misprint_claims;
mod neuron_bounds;
mod neuron_properties;
mod notes;
mod oracle_golden;
mod paper_cases;
mod parameter_limits;
mod precision;
mod reference_queue;
mod single_maths;
mod stability_limits;
mod theory_claims;
mod wheel_properties;
