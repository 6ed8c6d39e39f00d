//! Gains, and what they leave in reserve.

mod tuning_gains;
mod tuning_margins;
mod tuning_motion;
mod tuning_paper;
mod tuning_paper_margins;
