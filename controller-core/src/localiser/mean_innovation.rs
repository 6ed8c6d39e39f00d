//! Fixes that stay to one side of the pose: it is more off than its covariance says, as after wheels that slid.
//!
//! ```text
//! m ← m + a (ν − m) − taken          P ← P + min(max(m² − n² S a/(2 − a), 0), s²)          S = P + r
//! ```
//!
//! Innovations of a consistent filter are uncorrelated, and their mean m has the variance S a/(2 − a). The excess of m beyond n standard
//! deviations is added to the variance of the pose, so that the next fixes correct more of it: no more than the wheels rolled since the last
//! fix, s, for a base that rests does not slide, and noise that is correlated in time does not move one that has parked.
//!
//! | symbol | what | unit |
//! | --- | --- | --- |
//! | ν | innovation of x, y or the heading | m, rad |
//! | P, r | variance of that coordinate of the pose, and of the fix | m², rad² |
//! | s | way of the faster wheel; of the heading that over half the track | m, rad |

use crate::scalar::Scalar;
use crate::types::Pose;

/// a: the mean remembers (2 − a)/a = seven fixes. In so many a base at rest corrects a third of an error.
const SHARE: f64 = 0.25;
/// n: one mean in 370 is further off by chance.
const DEVIATIONS: f64 = 3.0;

/// m: mean of the last innovations, less what was taken of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MeanInnovation<T>(Pose<T>);

impl<T: Scalar> MeanInnovation<T> {
    /// Another fix, which was `off` by so much.
    pub(super) fn see(&mut self, off: &Pose<T>) {
        let share = T::from_f64(SHARE);
        let Self(mean) = self;
        mean.x += share * (off.x - mean.x);
        mean.y += share * (off.y - mean.y);
        mean.theta += share * (off.theta - mean.theta);
    }

    /// So much was taken of it: the pose is off by that less.
    pub(super) fn take(&mut self, taken: &Pose<T>) {
        let Self(mean) = self;
        mean.x -= taken.x;
        mean.y -= taken.y;
        mean.theta -= taken.theta;
    }

    /// Squares beyond those of noise, 0 or less where there are none: of x, y and the heading, whose innovations have these `variances`.
    #[inline(always)]
    pub(super) fn excess(&self, variances: (T, T, T)) -> (T, T, T) {
        let noise = T::from_f64(DEVIATIONS * DEVIATIONS * SHARE / (2.0 - SHARE));
        let excess = |mean: T, variance: T| mean * mean - noise * variance;
        let (Self(Pose { x, y, theta }), (xx, yy, tt)) = (self, variances);
        (excess(*x, xx), excess(*y, yy), excess(*theta, tt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of fixes that are off by 1 in each coordinate the mean is 1 − (3/4)ⁿ; with what is taken of it, that less.
    #[test]
    fn it_is_the_mean_of_seven_fixes() {
        let mut mean = MeanInnovation::<f64>::default();
        for n in 1..=30 {
            mean.see(&Pose::new(1.0, -2.0, 3.0));
            let share = 1.0 - 0.75_f64.powi(n);
            let MeanInnovation(Pose { x, y, theta }) = mean;
            assert!((x - share).abs() < 1e-15);
            assert!((y + 2.0 * share).abs() < 1e-15);
            assert!((theta - 3.0 * share).abs() < 1e-15);
        }
        mean.take(&Pose::new(0.5, -1.0, 1.5));
        let MeanInnovation(Pose { x, y, theta }) = mean;
        assert!((x - 0.5).abs() < 1e-3 && (y + 1.0).abs() < 1e-3 && (theta - 1.5).abs() < 1e-3);
    }

    /// Three standard deviations of a mean of seven, 9/7 of a fix's variance, are noise.
    #[test]
    fn noise_is_no_excess() {
        let mean = MeanInnovation(Pose::new(3.0_f64, -6.0, 9.0));
        let (x, y, theta) = mean.excess((7.0, 7.0, 7.0));
        assert!(x.abs() < 1e-14 && (y - 27.0).abs() < 1e-13 && (theta - 72.0).abs() < 1e-13);
    }
}
