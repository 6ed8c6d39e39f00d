//! Published control laws for two-wheeled robots, written afresh from their papers and manuals, to compare the default
//! law with.
//!
//! Each maps a pose to a wanted twist, and nothing else: limits, velocity loop, disturbance estimate and motors are the
//! core's, the same for all ([`controller_core::motion`]). Gains are plain numbers in the order of each law's list of
//! [`Gain`]s, so that a tuner can turn them. Single precision and the core's maths, as on a chip.
//!
//! | law | source |
//! | --- | --- |
//! | [`Ramsete`] | Samson and Ait-Abderrahim 1991; De Luca, Oriolo, Vendittelli 2001, Eq. (5.12); constants of WPILib |
//! | [`LtvUnicycle`] | linear-quadratic regulator about the reference; weights of WPILib |
//! | [`Graceful`] | Park and Kuipers, ICRA 2011; constants of Nav2's graceful controller |
//! | [`PurePursuit`] | Macenski et al. 2023, regulated pure pursuit; constants of Nav2 |
//! | [`Aicardi`] | Aicardi, Casalino, Bicchi, Balestrino, IEEE RAM 1995, with its constants |
//! | [`Samson`] | Samson, IEEE TAC 1995; Morin and Samson, Springer Handbook of Robotics, chapter 34 |
//! | [`TurnDriveTurn`] | what every hobbyist does: turns and drives with trapezoids |
//! | [`TwoPids`] | a PID on the distance and one on the heading, as in the turtlesim tutorial of ROS |
//! | `Mpc` (feature `mpc`) | linear MPC on the tracking error, after Klančar and Škrjanc, RAS 2007 |
#![cfg_attr(not(feature = "mpc"), no_std)]
#![forbid(unsafe_code)]

mod aicardi;
mod graceful;
mod law;
mod ltv;
#[cfg(feature = "mpc")]
mod mpc;
mod plan;
mod pure_pursuit;
mod pursuit;
mod ramsete;
mod samson;
mod trapezoid;
mod turn_drive_turn;
mod two_pids;

pub use aicardi::Aicardi;
pub use graceful::Graceful;
pub use law::{Body, Gain, Job, Now, Path, Rival, Wanted};
pub use ltv::LtvUnicycle;
#[cfg(feature = "mpc")]
pub use mpc::Mpc;
pub use pure_pursuit::PurePursuit;
pub use ramsete::Ramsete;
pub use samson::Samson;
pub use turn_drive_turn::TurnDriveTurn;
pub use two_pids::TwoPids;
