//! How far heading and bias may be off: the covariance of a Kalman filter of two states.
//!
//! ```text
//! h' = −β          h: heading, true less estimated;  β: bias, true less estimated
//! ```

use crate::scalar::Scalar;

/// Covariance of heading and bias \[rad², rad²/s, rad²/s²\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spread<T> {
    pub(super) heading: T,
    cross: T,
    pub(super) bias: T,
}

/// What an observation moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gain<T> {
    pub(super) heading: T,
    pub(super) bias: T,
}

impl<T: Scalar> Spread<T> {
    pub(super) fn new(heading: T, bias: T) -> Self {
        let cross = T::ZERO;
        Self {
            heading,
            cross,
            bias,
        }
    }

    /// Over a time `t` with heading noise of variance `noise` and bias noise of variance `walk`:
    /// P ← F P Fᵀ + Q with F = (1, −t; 0, 1).
    pub(super) fn pass(&mut self, t: T, noise: T, walk: T) {
        let moved = self.cross - t * self.bias;
        self.heading = self.heading - t * (self.cross + moved) + noise;
        self.cross = moved;
        self.bias += walk;
    }

    /// The heading was seen with this variance: K = P H/(H P Hᵀ + r).
    pub(super) fn see_heading(&mut self, variance: T) -> Gain<T> {
        let per = T::ONE / (self.heading + variance);
        let gain = Gain {
            heading: self.heading * per,
            bias: self.cross * per,
        };
        // Rounding makes no variance negative.
        self.bias = above_zero(self.bias - gain.bias * self.cross);
        self.cross = self.cross - gain.heading * self.cross;
        self.heading = gain.heading * variance;
        gain
    }

    /// The bias was seen with this variance.
    pub(super) fn see_bias(&mut self, variance: T) -> Gain<T> {
        let per = T::ONE / (self.bias + variance);
        let gain = Gain {
            heading: self.cross * per,
            bias: self.bias * per,
        };
        self.heading = above_zero(self.heading - gain.heading * self.cross);
        self.cross = self.cross - gain.bias * self.cross;
        self.bias = gain.bias * variance;
        gain
    }

    /// Nothing is known of the bias but that it is within its limit, and less of the heading.
    pub(super) fn forget_bias(&mut self, bias: T) {
        *self = Self::new(self.heading, bias);
    }
}

fn above_zero<T: Scalar>(value: T) -> T {
    if value > T::ZERO { value } else { T::ZERO }
}

#[cfg(test)]
mod tests {
    use super::Spread;

    /// Seen once a second for a minute with noise of 5 mrad: the variance of a slope through 60 such points is 12 σ²/n³.
    #[test]
    fn a_line_through_headings_has_the_spread_of_a_regression() {
        let mut spread = Spread::<f64>::new(1.0, 1.0);
        for _ in 0..60 {
            spread.pass(1.0, 0.0, 0.0);
            spread.see_heading(25.0e-6);
        }
        let slope = 12.0 * 25.0e-6 / f64::powi(60.0, 3);
        assert!((spread.bias / slope - 1.0).abs() < 0.01, "{spread:?}");
        // At the end of a line the value is known to 4 σ²/n.
        assert!((spread.heading / (4.0 * 25.0e-6 / 60.0) - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_bias_that_is_seen_leaves_less_of_the_heading_in_doubt() {
        let mut spread = Spread::<f64>::new(0.0, 1.0e-4);
        spread.pass(10.0, 0.0, 0.0);
        assert!((spread.heading - 1.0e-2).abs() < 1e-12);
        let gain = spread.see_bias(1.0e-10);
        assert!((gain.bias - 1.0).abs() < 1e-5 && (gain.heading + 10.0).abs() < 1e-3);
        assert!(spread.heading < 2.0e-8 && spread.bias < 1.1e-10);
    }
}
