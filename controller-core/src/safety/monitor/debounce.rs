//! How long something has held without a break.

use crate::safety::detector_params::Timeout;

/// Time that saturates instead of wrapping around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Debounce {
    us: u32,
}

impl Debounce {
    /// Nothing yet.
    pub(crate) const NONE: Self = Self { us: 0 };

    /// Whether `condition` has now held long enough. The tick that ends with it is counted in full.
    pub(crate) const fn holds(&mut self, condition: bool, dt_us: u32, timeout: Timeout) -> bool {
        if !condition {
            self.us = 0;
            return false;
        }
        self.us = self.us.saturating_add(dt_us);
        timeout.passed(self.us)
    }

    /// Takes a tick in which the condition held or did not.
    #[inline(always)]
    pub(crate) const fn count(&mut self, condition: bool, dt_us: u32) {
        if condition {
            self.us = self.us.saturating_add(dt_us);
        } else {
            self.us = 0;
        }
    }

    /// It has held for a time of more than 0.
    pub(crate) const fn has_lasted(self, timeout: Timeout) -> bool {
        timeout.passed(self.us)
    }
}
