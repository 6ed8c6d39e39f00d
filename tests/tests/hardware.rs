//! What a real base adds: encoders, poses, motors, faults.

mod base;
mod base_events;
mod faults;
mod gyro;
mod localiser_biases;
mod localiser_fusion;
mod localiser_gate;
mod localiser_oracle;
mod localiser_params;
mod localiser_parking;
mod localiser_slide;
mod localiser_slip;
mod motor;
mod motor_params;
mod motor_speed;
mod odometry;
mod odometry_reset;
mod odometry_slow;
mod over_speed;
mod safety_detectors;
mod safety_quiet;
mod safety_supervisor;
mod speed_base;
mod stopping;
