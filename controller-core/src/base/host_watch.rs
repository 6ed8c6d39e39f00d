//! How long the host has been silent.
//!
//! Two facts, each with one count and one event, by the same timeout (`DetectorParams::command`):
//!
//! | fact | counted | event |
//! | --- | --- | --- |
//! | the host is gone: no frame comes | where there is a link, [`BaseController::watch_link`](super::BaseController::watch_link) | `Event::LinkLost`, a controlled stop whatever the policy says |
//! | the host is there and gives no order where one is due | [`BaseController::tick`](super::BaseController::tick) | `Fault::CommandStale`, answered by the policy |
//!
//! An order is due in every tick while the base follows references or drives by velocity. Where there is no link, orders are the only sign of the host, and
//! one is due in every state.

use crate::safety::{Silence, Timeout};

/// Both counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HostWatch {
    frames: Silence,
    orders: Silence,
}

impl HostWatch {
    /// Seen just now.
    pub(super) const NEW: Self = Self {
        frames: Silence::NONE,
        orders: Silence::NONE,
    };

    /// A sound frame came.
    pub(super) const fn frame_seen(&mut self) {
        self.frames = Silence::NONE;
    }

    /// The host gave an order, or none is due.
    pub(super) const fn order_seen(&mut self) {
        self.orders = Silence::NONE;
    }

    /// A tick without an order, or with one.
    pub(super) fn order(&mut self, dt_us: u32, period_us: u32, given: bool) {
        self.orders = self
            .orders
            .after(silent_us(self.orders, dt_us, period_us), given);
    }

    /// Time since the last order that was due \[µs\].
    pub(super) const fn order_age_us(&self) -> u32 {
        self.orders.us()
    }

    /// A tick of the link; whether the silence would be too long by the next tick, so that the stop begins within the timeout.
    pub(super) fn is_lost(&mut self, dt_us: u32, period_us: u32, timeout: Timeout) -> bool {
        self.frames = self
            .frames
            .after(silent_us(self.frames, dt_us, period_us), false);
        match timeout {
            Timeout::AfterUs(limit) => self.frames.us().saturating_add(period_us) > limit,
            Timeout::Off => false,
        }
    }
}

/// For how long the host was silent in a tick \[µs\]. In one at whose begin nothing was missing that is a period at most: a longer tick says
/// nothing of the host, only of itself, and is a fault of its own.
fn silent_us(until_now: Silence, dt_us: u32, period_us: u32) -> u32 {
    match until_now.us() {
        0 => dt_us.min(period_us),
        _ => dt_us,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Timeout = Timeout::AfterUs(100_000);

    /// At 10 ms, frames cease: by the end of the tenth tick without one the timeout would have passed.
    #[test]
    fn a_link_is_lost_a_tick_before_the_timeout() {
        let mut watch = HostWatch::NEW;
        let lost = (1..).find(|_| watch.is_lost(10_000, 10_000, LIMIT));
        assert_eq!(lost, Some(10));
        watch.frame_seen();
        assert!(!watch.is_lost(10_000, 10_000, LIMIT));
        assert!(!watch.is_lost(500_000, 10_000, Timeout::Off));
    }

    /// Nor is a late tick a host that gave no order, where none was due at its begin.
    #[test]
    fn a_long_tick_says_nothing_of_orders() {
        let mut watch = HostWatch::NEW;
        watch.order(150_000, 20_000, false);
        assert_eq!(watch.order_age_us(), 20_000);
        watch.order(150_000, 20_000, false);
        assert_eq!(watch.order_age_us(), 170_000);
        watch.order(150_000, 20_000, true);
        assert_eq!(watch.order_age_us(), 0);
    }

    /// A tick of 95 ms in which a frame came is a late tick, not a host that was silent; the next one counts in full.
    #[test]
    fn a_long_tick_with_a_frame_is_no_silence() {
        let mut watch = HostWatch::NEW;
        assert!(!watch.is_lost(95_000, 10_000, LIMIT));
        assert!(watch.is_lost(95_000, 10_000, LIMIT));
    }

    #[test]
    fn frames_are_no_orders_and_orders_no_frames() {
        let mut watch = HostWatch::NEW;
        watch.order(10_000, 10_000, false);
        watch.frame_seen();
        assert_eq!(watch.order_age_us(), 10_000);
        assert!(!watch.is_lost(10_000, 10_000, LIMIT));
        watch.order(10_000, 10_000, true);
        assert_eq!(watch.order_age_us(), 0);
        assert_eq!(watch.frames.us(), 10_000);
    }
}
