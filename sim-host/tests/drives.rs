//! Runs in the loop.

mod bases;
mod bases_missions;
mod closed_loop;
mod controller_port;
mod drive_files;
mod drive_scenarios;
mod live;
mod metrics;
mod motion;
mod plant;
mod plant_hal;
mod slopes;
