//! Small watchers, each fed once a tick with the time since the tick before.

use controller_core::types::{Measured, WheelSpeeds, WheelTorques};

use super::settings::{Arrival, LinkWatch, StallWatch};

/// Time since the host was last heard.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silence {
    us: u32,
}

impl Silence {
    /// The host was heard.
    pub const fn heard(&mut self) {
        self.us = 0;
    }

    /// Whether the silence would be too long by the next tick.
    pub const fn lost(&mut self, watch: LinkWatch, elapsed_us: u32, period_us: u32) -> bool {
        self.us = self.us.saturating_add(elapsed_us);
        match watch {
            LinkWatch::StopAfterUs(limit) => self.us.saturating_add(period_us) > limit,
            LinkWatch::Off => false,
        }
    }
}

/// Late ticks, in a row and in all.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overruns {
    row: u8,
    total: u32,
}

impl Overruns {
    /// Takes the time since the tick before; whether too many ticks in a row came late.
    pub const fn too_many(&mut self, elapsed_us: u32, late_us: u32, most: u8) -> bool {
        if elapsed_us > late_us {
            self.row = self.row.saturating_add(1);
            self.total = self.total.saturating_add(1);
        } else {
            self.row = 0;
        }
        self.row >= most
    }

    /// Late ticks since power-on.
    pub const fn total(&self) -> u32 {
        self.total
    }
}

/// How long something has held without a break.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held {
    us: u32,
}

impl Held {
    /// Whether `condition` has now held for `long_us`.
    pub const fn holds(&mut self, condition: bool, elapsed_us: u32, long_us: u32) -> bool {
        if condition {
            self.us = self.us.saturating_add(elapsed_us);
        } else {
            self.us = 0;
        }
        condition && self.us >= long_us
    }
}

/// Wheels that are told to turn and do not.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stall {
    right: Held,
    left: Held,
}

impl Stall {
    /// Whether a wheel has stood still under torque for too long.
    pub fn stuck(
        &mut self,
        watch: &StallWatch,
        torques: &WheelTorques<f32>,
        speeds: &WheelSpeeds<f32>,
        elapsed_us: u32,
    ) -> bool {
        let stands = |torque: f32, speed: f32| {
            torque.abs() >= watch.torque_nm && speed.abs() < watch.speed_rad_s
        };
        let right = stands(torques.right, speeds.right);
        let left = stands(torques.left, speeds.left);
        // Both are fed, whatever the first one says.
        let right = self.right.holds(right, elapsed_us, watch.after_us);
        let left = self.left.holds(left, elapsed_us, watch.after_us);
        right || left
    }
}

/// The robot stands, wherever it is.
pub fn at_rest(arrival: &Arrival, measured: &Measured<f32>) -> bool {
    measured.twist.linear.abs() < arrival.speed_m_s
        && measured.twist.angular.abs() < arrival.turn_rad_s
}
