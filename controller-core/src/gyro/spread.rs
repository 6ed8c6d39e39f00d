//! How far heading, bias and scale may be off: the covariance of a Kalman filter of three states.
//!
//! ```text
//! Δh = −T β + φ κ     h: heading, true less estimated;  β: bias, true less estimated;  κ: scale, likewise
//! ```
//!
//! over a reading of the time T and the turn φ.

use crate::scalar::Scalar;

/// Covariance of heading h \[rad\], bias b \[rad/s\] and scale s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spread<T> {
    pub(super) hh: T,
    hb: T,
    hs: T,
    pub(super) bb: T,
    bs: T,
    ss: T,
}

/// What an observation moves, as shares of what is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gain<T> {
    pub(super) heading: T,
    pub(super) bias: T,
    pub(super) scale: T,
}

/// The scale is never known better than to 1e-4: no gyro is more linear.
const LINEAR: f64 = 1.0e-8;

impl<T: Scalar> Spread<T> {
    pub(super) fn new(heading: T, bias: T, scale: T) -> Self {
        Self {
            hh: heading,
            bb: bias,
            ss: scale,
            ..Self::default()
        }
    }

    /// P ← F P Fᵀ + Q with F = (1, −t, turn; 0, 1, 0; 0, 0, 1), where `noise` and `walk` are the variances that come to heading and bias.
    pub(super) fn pass(&mut self, t: T, turn: T, noise: T, walk: T) {
        let hb = self.hb - t * self.bb + turn * self.bs;
        let hs = self.hs - t * self.bs + turn * self.ss;
        self.hh += turn * (self.hs + hs) - t * (self.hb + hb) + noise;
        self.hb = hb;
        self.hs = hs;
        self.bb += walk;
    }

    /// The heading was seen with this variance: K = P H/(H P Hᵀ + r).
    pub(super) fn see_heading(&mut self, variance: T) -> Gain<T> {
        let per = T::ONE / (self.hh + variance);
        let gain = Gain {
            heading: self.hh * per,
            bias: self.hb * per,
            scale: self.hs * per,
        };
        self.bb = above_zero(self.bb - gain.bias * self.hb);
        self.bs -= gain.bias * self.hs;
        self.ss -= gain.scale * self.hs;
        self.keep_scale();
        self.hb -= gain.heading * self.hb;
        self.hs -= gain.heading * self.hs;
        self.hh = gain.heading * variance;
        gain
    }

    /// The bias was seen with this variance.
    pub(super) fn see_bias(&mut self, variance: T) -> Gain<T> {
        let per = T::ONE / (self.bb + variance);
        let gain = Gain {
            heading: self.hb * per,
            bias: self.bb * per,
            scale: self.bs * per,
        };
        self.hh = above_zero(self.hh - gain.heading * self.hb);
        self.hs -= gain.heading * self.bs;
        self.ss -= gain.scale * self.bs;
        self.keep_scale();
        self.hb -= gain.heading * self.bb;
        self.bs -= gain.bias * self.bs;
        self.bb = gain.bias * variance;
        gain
    }

    fn keep_scale(&mut self) {
        let least = T::from_f64(LINEAR);
        if self.ss < least {
            self.ss = least;
        }
    }

    /// The bias is known better, by another way: `left` of its variance.
    pub(super) fn narrow_bias(&mut self, left: T) {
        self.bb = self.bb * left;
        self.hb = self.hb * left;
        self.bs = self.bs * left;
    }

    /// Nothing is known of the bias but that it is within its limit.
    pub(super) fn forget_bias(&mut self, variance: T) {
        self.bb = variance;
        self.hb = T::ZERO;
        self.bs = T::ZERO;
    }

    /// The heading is what it is for another reason.
    pub(super) fn set_heading(&mut self, variance: T) {
        self.hh = variance;
        self.hb = T::ZERO;
        self.hs = T::ZERO;
    }
}

/// Rounding makes no variance negative.
fn above_zero<T: Scalar>(value: T) -> T {
    if value > T::ZERO { value } else { T::ZERO }
}

#[cfg(test)]
mod tests {
    use super::Spread;

    /// Seen once a second for a minute with noise of 5 mrad: the variance of a slope through 60 such points is 12 σ²/n³.
    #[test]
    fn a_line_through_headings_has_the_spread_of_a_regression() {
        let mut spread = Spread::<f64>::new(1.0, 1.0, 0.0);
        for _ in 0..60 {
            spread.pass(1.0, 0.0, 0.0, 0.0);
            spread.see_heading(25.0e-6);
        }
        let slope = 12.0 * 25.0e-6 / f64::powi(60.0, 3);
        assert!((spread.bb / slope - 1.0).abs() < 0.01, "{spread:?}");
        // At the end of a line the value is known to 4 σ²/n.
        assert!((spread.hh / (4.0 * 25.0e-6 / 60.0) - 1.0).abs() < 0.05);
    }

    /// The same by turn: ten radians in sixty steps leave 12 σ²/(n Φ²) of the scale.
    #[test]
    fn turning_shows_the_scale() {
        let mut spread = Spread::<f64>::new(1.0, 0.0, 1.0e-4);
        for _ in 0..60 {
            spread.pass(1.0, 1.0 / 6.0, 0.0, 0.0);
            spread.see_heading(25.0e-6);
        }
        let slope = 12.0 * 25.0e-6 / (60.0 * 100.0);
        assert!((spread.ss / slope - 1.0).abs() < 0.02, "{spread:?}");
    }

    /// A turn of 2 rad by a scale that may be wrong by a per cent, and noise.
    #[test]
    fn turns_and_noise_add_to_the_doubt_of_the_heading() {
        let mut spread = Spread::<f64>::new(0.0, 0.0, 1.0e-4);
        spread.pass(0.0, 1.0, 1.0e-6, 0.0);
        spread.pass(0.0, 1.0, 1.0e-6, 0.0);
        assert!((spread.hh - (4.0e-4 + 2.0e-6)).abs() < 1e-12, "{spread:?}");
    }

    #[test]
    fn a_bias_that_is_seen_leaves_less_of_the_heading_in_doubt() {
        let mut spread = Spread::<f64>::new(0.0, 1.0e-4, 0.0);
        spread.pass(10.0, 0.0, 0.0, 0.0);
        assert!((spread.hh - 1.0e-2).abs() < 1e-12);
        let gain = spread.see_bias(1.0e-10);
        assert!((gain.bias - 1.0).abs() < 1e-5 && (gain.heading + 10.0).abs() < 1e-3);
        assert!(spread.hh < 2.0e-8 && spread.bb < 1.1e-10);
    }
}
