//! The law for a real base: any trajectory, any start, exact parking, within stated limits.
//!
//! The paper's law ([`crate::paper`]) divides by v_r, leaves a lateral error at the target and
//! knows no limit. This one keeps what is good in it, errors that pass through bounded neurons and
//! torques that never jump, and goes on:
//!
//! ```text
//! pose law ([`follow`], [`polar`]) -> wanted twist and its exact rate
//!    -> bridge (jumps of the wish fade)      -> governor (limits on speed, acceleration, jerk)
//!    -> torque (feed-forward + velocity loop) -> wheels (limit, shared by a policy; told back)
//! ```
//!
//! * Reference accelerations are fed forward exactly; neurons shape only the feedback.
//! * The wanted twist may jump (new task, new goal, new localisation); command and torque do not:
//!   per tick the wrench changes by at most L dt, [`Motion::force_rate_limit`] and
//!   [`Motion::moment_rate_limit`].
//! * Nothing winds up: a saturated torque sets the command back to what was achieved.
//! * What pushes the robot beside its wheels is estimated, within a bound, and compensated: friction
//!   and slopes leave no error.
//! * Who stands beside the goal tries again, a stated number of times, and then says so.
//!
//! `docs/motion.md` derives the laws and has the measurements.

mod arrival;
mod bridge;
mod controller;
mod disturbance;
mod follow;
mod gains;
mod goal_checker;
mod governor;
mod hand_over;
mod lag;
mod limits;
mod params;
mod polar;
mod report;
mod retry;
mod saturation;

pub use arrival::{Arrival, AtRest};
pub use controller::{MotionController, Task};
pub use gains::MotionGains;
pub use limits::{Limits, Policy};
pub use params::{JumpThreshold, Motion, MotionParams};
pub use report::{Limited, Mode, MotionReport, Outcome};
pub use saturation::share;

pub(crate) use limits::COMMAND_SHARE;
pub(crate) use polar::{BEARING, COUPLING};
