//! The default law.

mod motion_arrival;
mod motion_disturbance;
mod motion_drive;
mod motion_faults;
mod motion_feed_forward;
mod motion_files;
mod motion_friction;
mod motion_hand_over;
mod motion_jumps;
mod motion_limits;
mod motion_margins;
mod motion_minimum_time;
mod motion_oracle;
mod motion_parking;
mod motion_path_end;
mod motion_precision;
mod motion_retries;
mod motion_robustness;
mod motion_saturation;
mod motion_settling;
mod motion_shipped;
mod motion_starts;
mod motion_table;
