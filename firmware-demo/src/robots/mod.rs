//! Robots as constants, made by `sim-host constants` from `bases/`.

mod hobby_1kg;
mod lab_10kg;
mod paper_30kg;

use controller_core::base::BaseParams;

/// A robot: how often it ticks, and everything that is to be known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotConstants {
    /// Time between ticks \[µs\].
    pub period_us: u32,
    /// Parameters of its base, still to be validated.
    pub base: BaseParams<f32>,
}

/// `bases/paper-30kg.toml`.
pub const PAPER_30KG: RobotConstants = RobotConstants {
    period_us: paper_30kg::PERIOD_US,
    base: paper_30kg::BASE,
};

/// `bases/lab-10kg.toml`.
pub const LAB_10KG: RobotConstants = RobotConstants {
    period_us: lab_10kg::PERIOD_US,
    base: lab_10kg::BASE,
};

/// `bases/hobby-1kg.toml`.
pub const HOBBY_1KG: RobotConstants = RobotConstants {
    period_us: hobby_1kg::PERIOD_US,
    base: hobby_1kg::BASE,
};
