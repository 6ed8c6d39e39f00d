//! Motion control for two-wheeled robots: follow a moving reference, park at a pose, with bounded
//! commands and torques that do not jump. No heap, no panic, no clock, no I/O.
//!
//! The laws are those of Cao, Zhao and Wang, *Trajectory Tracking and Point Stabilization of
//! Nonholonomic Mobile Robot*, with the misprints corrected (`docs/errata.md`). Equations stand
//! one to a function, with their number, so that each can be used and checked on its own.
//!
//! | layer | modules |
//! | --- | --- |
//! | numbers | [`scalar`], [`maths`], [`angle`] |
//! | quantities | [`types`], [`params`], [`error`] |
//! | robot | [`model`] (1)-(3), [`wheels`] B̄ |
//! | reference | [`mod@reference`] (6), [`queue`], [`pose_error`] (7)-(9) |
//! | neurons | [`shunting`] (4)(5), [`neuron`] |
//! | laws | [`backstepping`] (10)(13), [`tracking`] (15)(18), [`parking`] (20), [`torque`] (12)(14)(16)(21), [`handover`] (23), [`neural_law`] (17)(22) |
//! | controllers | [`neural::NeuralController`], [`plain::PlainController`], [`demand`], [`report`] |
//! | a real base | [`motion`]: any trajectory, exact parking, limits, jumps, arrival |
//! | a whole base | [`base`]: from encoders to wheels in one tick |
//! | base | [`hal`] traits for wheels, encoders, clock; [`odometry`], [`localiser`] |
//! | motors | [`motor`]: torque to duty, wheel speeds for drivers that take those, braking distances |
//! | safety | [`safety`]: faults and reactions, detectors, supervisor, stopping distance |
//! | insight | [`stability`], [`lyapunov`] (24)-(27) |
//! | gains | [`tuning`]: from wishes, with margins |
#![no_std]
#![forbid(unsafe_code)]

pub mod angle;
pub mod backstepping;
pub mod base;
pub mod demand;
pub mod error;
pub mod hal;
pub mod handover;
pub mod localiser;
pub mod lyapunov;
pub mod maths;
pub mod model;
pub mod motion;
pub mod motor;
pub mod neural;
pub mod neural_law;
pub mod neuron;
pub mod odometry;
mod output;
pub mod params;
pub mod parking;
pub mod plain;
pub mod pose_error;
pub mod queue;
mod range;
pub mod reference;
pub mod report;
pub mod safety;
pub mod scalar;
pub mod shunting;
pub mod stability;
pub mod torque;
pub mod tracking;
pub mod tuning;
pub mod types;
pub mod wheels;
