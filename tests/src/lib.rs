//! What the tests share: the oracle, the golden traces, the core in closed loop, seeded states and the tolerances.

use std::path::{Path, PathBuf};

pub mod aicardi;
pub mod check;
pub mod core_draw;
pub mod core_draw_loop;
pub mod core_flow;
pub mod core_loop;
pub mod core_params;
pub mod encoded;
pub mod fixes;
pub mod fixtures;
pub mod fuzz;
pub mod golden;
pub mod host_cost;
pub mod ideal;
pub mod led;
pub mod localised;
pub mod motion_base;
pub mod motion_friction;
pub mod motion_loop;
pub mod motion_oracle;
pub mod motion_parking;
pub mod motion_rest;
pub mod motion_tracking;
pub mod motion_wheel_friction;
pub mod oracle;
pub mod plant;
pub mod program;
pub mod random;
#[cfg(doctest)]
pub mod readmes;
pub mod rolling;
pub mod safety_rig;
pub mod stated;
pub mod tolerance;
pub mod tuning_loop;

/// The root of the workspace.
pub fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().unwrap_or(root)
}

/// Where `sh tests/run` builds the images of boards, so that tests build only what differs.
pub fn boards_target() -> PathBuf {
    root().join("target/boards")
}
