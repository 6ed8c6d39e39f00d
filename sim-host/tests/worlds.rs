//! The realistic plant against closed forms.

mod world_body;
mod world_common;
mod world_drive;
mod world_friction;
mod world_grip;
mod world_senses;
mod world_speed;
mod world_steps;
