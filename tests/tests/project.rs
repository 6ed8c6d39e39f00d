//! The project itself: what depends on what, what the documents point to, and where each equation is.

mod dependencies;
mod modules;
mod traceability;
