//! The program as it is used.

mod bench;
mod cli;
mod drive_cli;
mod faults;
mod monitor;
mod own_robot;
mod own_robot_tune;
mod parts;
mod pil;
mod program;
mod robustness;
mod scenario_errors;
