//! What the real boards share: everything but the pins.
//!
//! ```text
//! receive interrupt -> Bytes -> Line (background) -> CommandReceiver ─┐
//! timer interrupt   -> BoardBase::tick: encoders, ControlServer, base    ─┴─> motors, enable pin
//! ```
//!
//! A board brings a clock, two encoders, two PWM outputs, two direction pins, one enable pin and a line; [`start`]
//! makes of them the two halves that run in the timer's interrupt and in the background.
#![no_std]

mod base;
mod bytes;
pub mod config;
mod entry;
mod line;
mod supply;

/// The robot that is driven, as `sim-host constants` writes it.
pub mod robot {
    include!(env!("ROBOT_CONSTANTS"));
}

pub use base::{BoardBase, Halves, Parts, StartError, start};
pub use bytes::Bytes;
pub use line::{BAUD, Line};
pub use supply::{NoSupply, Supply};

// What a board needs of the workspace, so that it depends on this crate only.
pub use controller_core::hal::{
    Clock, ErrorKind, ErrorType, NoGyro, WheelCounts, WheelEncoders, Widened, YawGyro,
};
pub use firmware_demo::control_server::Queues;
pub use firmware_demo::drive::MotorSide;
#[cfg(target_os = "none")]
pub use firmware_demo::panicked;
pub use firmware_demo::storage::{NoMemory, Slots};
