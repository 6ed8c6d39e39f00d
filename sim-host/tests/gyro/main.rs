//! Bases with a gyro: heading without poses, a wheel on ice, poses that fail for a while, gyros that lie.

mod drift;
mod ice;
mod lies;
mod lost_poses;
mod rig;
