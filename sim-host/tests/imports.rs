//! Trajectory files, good and bad.

mod import_formats;
mod import_fuzz;
mod import_limits;
mod import_noise;
mod import_refusals;
