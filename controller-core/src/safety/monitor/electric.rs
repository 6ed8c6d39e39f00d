//! Currents and supply.

use super::debounce::Debounce;
use crate::safety::detector_params::{CurrentDetectorParams, SupplyDetectorParams, Timeout};
use crate::safety::fault::Side;
use crate::safety::inputs::Currents;
use crate::scalar::Scalar;

/// Motors above their current.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct OverCurrent {
    right: Debounce,
    left: Debounce,
}

impl OverCurrent {
    /// The motors that have been above the limit for too long. What is not a number counts as above, what is not measured does not.
    pub(super) fn advance<T: Scalar>(
        &mut self,
        settings: &CurrentDetectorParams<T>,
        currents: Option<Currents<T>>,
        dt_us: u32,
    ) -> Option<Side> {
        let Some(Currents { right, left }) = currents else {
            *self = Self::default();
            return None;
        };
        let above = |current: T| !current.is_finite() || current.abs() > settings.limit_a;
        let right = self.right.holds(above(right), dt_us, settings.after);
        let left = self.left.holds(above(left), dt_us, settings.after);
        Side::of(right, left)
    }
}

/// A supply that is too low, until it has recovered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct UnderVoltage {
    low: Debounce,
    found: bool,
}

impl UnderVoltage {
    /// Whether the supply is too low: found after the time below `low_v`, over at `recovered_v`. What is not
    /// a number counts as below. Without a measurement nothing changes.
    pub(super) fn advance<T: Scalar>(
        &mut self,
        settings: &SupplyDetectorParams<T>,
        supply_v: Option<T>,
        dt_us: u32,
    ) -> bool {
        if let Some(supply) = supply_v {
            let good = |least: T| supply.is_finite() && supply >= least;
            let lasted = self.low.holds(!good(settings.low_v), dt_us, settings.after);
            self.found = lasted || (self.found && !good(settings.recovered_v));
        }
        self.found
    }

    /// Whether it is too low, or on the way to be found so: motors then need not exert the command.
    /// Not for longer than the fault takes to be found, and never where it is not watched.
    pub(super) fn suspected(&self, settings: &SupplyDetectorParams<impl Scalar>) -> bool {
        self.found || (self.low != Debounce::NONE && settings.after != Timeout::Off)
    }
}
