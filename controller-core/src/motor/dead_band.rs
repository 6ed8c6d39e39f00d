//! The part of the duty for which a bridge does nothing.

use crate::range::signed;
use crate::scalar::Scalar;

/// Half width of the ramp through zero, as a share of the dead band.
///
/// The ramp's slope is 1/`RAMP` + 1: so much, and no more, is noise of the duty
/// magnified there. A quarter of a dead band of 5 % is 1.2 % of duty, an order above what one encoder count
/// does by its back-EMF.
const RAMP: f64 = 0.25;

/// Maps the desired duty onto the one to set, for a bridge that loses d₀ of it at either sign: |D| − d₀ acts, and nothing up to
/// d₀. Dead time loses a share of every period, diodes a voltage: neither grows with the duty.
///
/// ```text
/// D = d + d₀ sgn d         |d| ≥ β          the inverse
/// D = (1/RAMP + 1) d       |d| < β          β = RAMP d₀
/// ```
///
/// Both agree at |d| = β, so the map is continuous, rising and odd. The ramp stays below the inverse: the
/// bridge gives at most what was desired, never more, so the ramp adds no energy and feeds no oscillation
/// about zero. What it gives is short by less than β.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DeadBand<T> {
    width: T,
    ramp_end: T,
    ramp_slope: T,
}

impl<T: Scalar> DeadBand<T> {
    pub(super) fn new(width: T) -> Self {
        let slope = if width > T::ZERO {
            1.0 / RAMP + 1.0
        } else {
            1.0
        };
        Self {
            width,
            ramp_end: T::from_f64(RAMP) * width,
            ramp_slope: T::from_f64(slope),
        }
    }

    /// Share of the supply that full duty leaves.
    #[inline(always)]
    pub(super) fn most(&self) -> T {
        T::ONE - self.width
    }

    /// The duty to set for a desired one of at most [`most`](Self::most); in [−1, 1].
    #[inline(always)]
    pub(super) fn beyond(&self, desired: T) -> T {
        let size = desired.abs();
        if size < self.ramp_end {
            return self.ramp_slope * desired;
        }
        if size > T::ZERO {
            // The sum may round above 1 by one unit in the last place.
            let set = self.width + size;
            let set = if set > T::ONE { T::ONE } else { set };
            signed(set, desired)
        } else {
            T::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_branches_meet_and_stay_within_one() {
        for hundredths in 0..=50 {
            let band = DeadBand::new(hundredths as f32 * 0.01);
            let (below, above) = (band.ramp_end * (1.0 - 1.0e-6), band.ramp_end);
            // A step of 1e-6 of at most 0.125, times a slope of at most 5, and rounding of numbers below 1.
            assert!((band.beyond(above) - band.beyond(below)).abs() < 1.0e-6);
            let full = band.beyond(band.most());
            assert!((full - 1.0).abs() <= f32::EPSILON, "{full}");
            assert_eq!(band.beyond(1.0), 1.0);
            assert_eq!(band.beyond(-1.0), -1.0);
            assert_eq!(band.beyond(0.0), 0.0);
        }
    }

    #[test]
    fn no_dead_band_changes_nothing() {
        let band = DeadBand::new(0.0_f64);
        for desired in [-1.0, -1.0e-9, 1.0e-30, 0.3, 1.0] {
            assert_eq!(band.beyond(desired), desired);
        }
    }
}
