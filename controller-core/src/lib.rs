//! Motion control for two-wheeled robots: follow a moving reference, park at a pose, with bounded
//! commands and torques that do not jump. No heap, no panic, no clock, no I/O.
//!
//! | layer | modules |
//! | --- | --- |
//! | numbers | [`scalar`], [`maths`] and its [`single`] precision, [`angle`] |
//! | quantities | [`types`], [`error`] |
//! | robot | [`robot`] (1)-(3), [`wheels`] B̄ |
//! | reference | [`mod@reference`] (6), [`queue`], [`pose_error`] (7)-(9) |
//! | neurons | [`shunting`] (4)(5), [`neuron`] |
//! | the law for a real base | [`motion`]: any trajectory, exact parking, limits, jumps, arrival; [`torque`] |
//! | a whole base | [`base`]: from encoders to wheels in one tick |
//! | sensors, drives | [`hal`] traits for wheels, encoders, gyro, clock; [`odometry`], [`gyro`], [`localiser`] |
//! | motors | [`motor`]: torque to duty, wheel speeds for drivers that take those, braking distances |
//! | safety | [`safety`]: faults and reactions, detectors, supervisor, stopping distance |
//! | gains | [`tuning`]: from a design specification, with margins; [`stability`] |
//! | the paper's law | [`paper`]: Cao, Zhao and Wang, equation by equation |
//!
//! Numbers in parentheses are the equations of that paper.
//!
//! The root has the names of a first program; `examples/` has such programs.
//!
//! ```
//! use controller_core::motion::SaturationPolicy;
//! use controller_core::{Limits, Measured, MotionController, MotionParams, Outcome, Pose, Robot, Task};
//!
//! // Robot and limits are yours; gains follow from them.
//! let limits = Limits {
//!     speed: 1.0, turn_rate: 2.0, rim_speed: 1.2, accel: 0.8, brake: 1.0, turn_accel: 3.0,
//!     jerk: 20.0, turn_jerk: 40.0, wheel_torque_nm: 8.0, policy: SaturationPolicy::KeepCurvature,
//! };
//! let motion = MotionParams::new(Robot::paper(), limits).validate()?;
//! let (task, measured) = (Task::Park(Pose::new(1.0, 0.5, 0.0)), Measured::default());
//! let mut controller: MotionController = MotionController::start(&motion, &task, &measured)?;
//! // Every tick: measure, step, set the wheels.
//! let report = controller.step(0.01, &task, &measured)?;
//! assert_eq!(report.outcome, Outcome::Driving);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

pub mod angle;
pub mod base;
mod cast;
mod check;
pub mod error;
pub mod gyro;
pub mod hal;
pub mod localiser;
pub mod maths;
pub mod motion;
pub mod motor;
pub mod neuron;
pub mod odometry;
pub mod paper;
pub mod pose_error;
pub mod queue;
mod range;
pub mod reference;
pub mod robot;
pub mod safety;
pub mod scalar;
pub mod shunting;
pub mod single;
pub mod stability;
pub mod torque;
pub mod tuning;
pub mod types;
pub mod wheels;

pub use base::{BaseController, BaseParams, Order, Sensed, WheelAction};
pub use motion::{Limits, MotionController, MotionParams, Outcome, Task};
pub use reference::Reference;
pub use robot::Robot;
pub use types::{Measured, Pose, Twist, WheelTorques};
pub use wheels::WheelGeometry;
