//! The law of Cao, Zhao and Wang, *Trajectory Tracking and Point Stabilization of Nonholonomic Mobile
//! Robot*, with the misprints corrected (`docs/errata.md`): what a study of the paper needs.
//!
//! Nothing outside of this module uses it: the law for a real base is [`crate::motion`]. Equations
//! stand one to a function, with their number, so that each can be used and checked on its own.
//!
//! | layer | modules |
//! | --- | --- |
//! | quantities | [`params`], [`demand`], [`report`] |
//! | laws | [`backstepping`] (10)(13), [`tracking`] (15)(18), [`parking`] (20), [`hand_over`] (23), [`neural_law`] (17)(22); [`crate::torque`] (12)(14)(16)(21) |
//! | controllers | [`neural::NeuralController`], [`plain::PlainController`] |
//! | insight | [`stability`], [`lyapunov`] (24)-(27), [`tuning`]: gains and margins |
//!
//! The neurons (4)(5) are [`crate::shunting`] and [`crate::neuron`]; the robot (1)-(3), the reference
//! (6) and the pose error (7)-(9) are [`crate::robot`], [`mod@crate::reference`] and [`crate::pose_error`].

pub mod backstepping;
pub mod demand;
pub mod hand_over;
pub mod lyapunov;
pub mod neural;
pub mod neural_law;
mod output;
pub mod params;
pub mod parking;
pub mod plain;
pub mod report;
pub mod stability;
pub mod tracking;
pub mod tuning;
