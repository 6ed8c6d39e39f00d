//! The law for a real base: any trajectory, any start, exact parking, driving by velocity, within stated limits.
//!
//! The paper's law ([`crate::paper`]) divides by v_r, leaves a lateral error at the target and
//! knows no limit. This one keeps what is good in it, errors that pass through bounded neurons and
//! torques that never jump, and goes on:
//!
//! ```text
//! task, pose -> error view -> pose law (follow, polar, drive) -> setpoint: a twist and its exact rate
//!    -> transition offset (jumps fade) -> governor (limits on speed, acceleration, jerk)
//!    -> velocity loop (with feed-forward)    -> wheels (limit, shared by a policy; fed back)
//! ```
//!
//! * Reference accelerations are fed forward exactly; neurons shape only the feedback.
//! * The setpoint may jump (new task, new goal, new localisation); command and torque do not:
//!   per tick the wrench changes by at most L dt, [`ValidMotionParams::force_rate_limit`] and
//!   [`ValidMotionParams::moment_rate_limit`].
//! * Nothing winds up: a saturated torque sets the command back to what was achieved.
//! * What pushes the robot beside its wheels is estimated, within a bound, and compensated: friction
//!   and slopes leave no error. So is what it carries ([`Load`]): a payload of 30 % does not make it late.
//! * Who stands beside the goal tries again, a stated number of times, and then says so.
//!
//! `docs/motion.md` derives the laws and has the measurements.

mod arrival;
mod controller;
mod disturbance;
mod drive;
mod error_view;
mod follow;
mod gains;
mod goal_checker;
mod governor;
mod hand_over;
mod lag;
mod law;
mod limits;
mod load;
mod manoeuvre;
mod observer_limits;
mod params;
mod parking;
mod path_end;
mod polar;
mod pose_law;
mod report;
mod retry;
mod saturation;
mod setpoint;
mod task;
mod transition_offset;
mod turn_demand;
mod velocity_loop;

pub(crate) use arrival::HEADING_DEVIATIONS;
pub use arrival::{Arrival, AtRest, Parking};
pub use controller::MotionController;
pub use drive::{check_goal, check_order};
pub use gains::MotionGains;
pub(crate) use gains::{BEARING, COUPLING, NOISE_HEADING_RAD, lateral_pair, turning_limits};
pub use hand_over::Remaining;
pub use limits::{Limits, SaturationPolicy};
pub use load::Load;
pub use params::{JumpThreshold, MotionParams, ValidMotionParams};
pub use path_end::{PathEnd, REFERENCE_TURN_SHARE};
pub use report::{Limited, Mode, MotionReport, Outcome};
pub use saturation::share;
pub use task::Task;

pub(crate) use law::MotionLaw;
pub(crate) use params::reach;
pub(crate) use retry::NEW_APPROACH;
pub(crate) use task::Asked;
