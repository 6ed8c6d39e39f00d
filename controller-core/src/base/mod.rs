//! A whole base, from encoders to wheels: one pure tick, the same on a chip, in the simulator, in tests.
//!
//! ```text
//! Sensed -> localiser -> monitor -> supervisor (policy) -> motion law -> WheelAction
//! Order  ------------------------------^                       |
//!            accelerations of the torques exerted <------------+
//! ```
//!
//! | part | module |
//! | --- | --- |
//! | where the base is | [`crate::localiser`] |
//! | what is wrong, and what is done about it | [`crate::safety`] |
//! | how long the host has been silent | [`BaseController::watch_link`] for frames, [`BaseController::tick`] for orders |
//! | where to, with what torque | [`crate::motion`] |
//! | torque to duty, for motors on bridges | [`crate::motor`], by the driver |
//! | wheel speeds, for drivers that close their own speed loop | [`DriveCommand::desired`], [`crate::motor::SpeedOutput`] |
//!
//! A tick never fails. Whatever comes in, what goes out is one [`WheelAction`]: torques within their
//! limit, an electrical brake, or a release; what was wrong stands in [`BaseReport`].

mod apply;
mod controller;
mod driving;
mod host_watch;
mod io;
mod locate;
mod motor_bias;
mod orders;
mod over_speed;
mod params;
mod report;
mod speed_drive;
mod wheel_friction;

pub use controller::{BaseController, REMEMBERED};
pub use io::{DriveCommand, Order, Sensed, WheelAction};
pub use params::{BaseError, BaseParams, ValidBaseParams};
pub use report::BaseReport;
