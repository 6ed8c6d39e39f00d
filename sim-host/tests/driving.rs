//! Driving by velocity: on bad floors, from a scenario, from a keyboard.

mod driving_slow;
mod driving_teleop;
