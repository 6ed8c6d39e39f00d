//! Parking manoeuvres near the minimum time: turns and drives that overlap, planned and sampled.
//!
//! A unicycle at rest goes to any pose by two turns and at most two drives, each a rest-to-rest motion of
//! one axis with limited jerk ([`profile`]). Which of them overlap, and by how much, is a [`candidate`]'s;
//! what angle and distances it needs is found by a bounded number of quasi-Newton steps ([`search`]);
//! the quickest one is driven as a reference ([`execution`]), which makes up for what the robot is aside of it ([`lateral_offset`]).

mod candidate;
mod execution;
mod lateral_offset;
mod path;
mod profile;
mod search;

pub(crate) use candidate::{PLAN_SHARE, Pace, PlanLimits};
pub(crate) use execution::{Execution, GoalSeen};
pub(crate) use lateral_offset::{LateralOffset, OffsetLimits, SETTING_S};
pub(crate) use profile::AxisLimits;
