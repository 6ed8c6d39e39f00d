//! The trajectory files that tests import and drive.

use std::io;
use std::path::PathBuf;

/// Those that can be driven, of every format that can.
pub const DRIVABLE: [&str; 14] = [
    "wpilib_dirty.json",
    "wpilib_gaps.json",
    "small_wpilib.json",
    "wpilib_2027.json",
    "choreo_v0.traj",
    "choreo_v0_track.traj",
    "choreo_v1.traj",
    "choreo_shifted.traj",
    "tum_planar.txt",
    "small_tum.txt",
    "table.csv",
    "table_bare.csv",
    "table_spin.csv",
    "small_table.csv",
];

/// Where a file is.
pub fn path(name: &str) -> PathBuf {
    crate::root().join("sim-host/tests/fixtures").join(name)
}

/// What is in it.
///
/// # Errors
/// There is none of this name.
pub fn read(name: &str) -> io::Result<Vec<u8>> {
    std::fs::read(path(name))
}
