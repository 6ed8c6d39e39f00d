//! The project itself: what depends on what, what the documents point to, and where each equation is.

mod api;
mod dependencies;
mod modules;
mod packages;
mod traceability;

/// The workspace's root.
fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
