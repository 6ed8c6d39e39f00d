//! Bases with a gyro: heading without poses, a wheel on ice, poses that fail for a while, faulty gyros.

mod drift;
mod faulty;
mod ice;
mod lost_poses;
mod rig;
