//! Time in which nothing came.

use super::Timeout;

/// How long something has not been seen: frames of the host, its orders, readings of the encoders. One count, compared with one
/// [`Timeout`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Silence {
    us: u32,
}

impl Silence {
    /// Seen just now.
    pub const NONE: Self = Self { us: 0 };

    /// After a tick of `dt_us`, in which it was seen or was not.
    pub const fn after(self, dt_us: u32, seen: bool) -> Self {
        let us = if seen {
            0
        } else {
            self.us.saturating_add(dt_us)
        };
        Self { us }
    }

    /// Since when \[µs\]; saturates.
    pub const fn us(self) -> u32 {
        self.us
    }

    /// It has lasted for the timeout.
    pub const fn exceeds(self, timeout: Timeout) -> bool {
        timeout.passed(self.us)
    }
}
