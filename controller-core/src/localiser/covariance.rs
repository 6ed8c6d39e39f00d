//! How far the believed pose may be off, and so what of a fix is to be taken: a Kalman filter of four states.
//!
//! True less believed are x, y, the heading θ and the curvature bias b, the turn that odometry has to add per way: wheels that
//! are not as large as stated. Over a chord (Δx, Δy) of the way s
//!
//! ```text
//! δx⁺ = δx − Δy (δθ + ½ s δb)      δθ⁺ = δθ + s δb
//! δy⁺ = δy + Δx (δθ + ½ s δb)      δb⁺ = δb
//! ```
//!
//! so that a fix beside the way tells of the heading, and a heading that is off of what it has led aside and of the wheels. What
//! comes to the errors is in [`Growth`]. A base that rests takes of each fix the share that its bandwidth states; one that
//! drives is less sure of where it is, and takes more.

use crate::scalar::Scalar;
use crate::types::Pose;

/// Share of [`drift`](super::FusionParams::drift) by which radii of the right and the left wheel differ from what is stated, each
/// its way, as a standard deviation: 0.25 % of 2 %. Tyres that wear by up to a per cent, evenly spread and not the same on both
/// sides, have 1 %/√12 = 0.29 % each. The rest of the drift is for floors.
const RADII: f64 = 1.0 / 8.0;
/// What the curvature bias changes by, as a share of that, over a metre: a load that moves, a tyre that warms. A third in 10 m.
const CHANGES: f64 = 0.1;
/// Share of the drift that a metre is wrong by, as a standard deviation: 1.2 mm of 2 %, of tyres that slip and joints of floors.
const PER_METRE: f64 = 0.06;
/// The same of a turn of a radian: 11.5 mrad of 2 %, a track that is wrong by up to the drift, evenly: wide tyres roll about another point than
/// is believed. √(1/3).
const PER_RADIAN: f64 = 0.577_350_269_189_625_8;
/// Variances, over those of a fix, above which nothing is known: a fix is then taken whole. Single precision still keeps what
/// remains of less, 1e5 × 6e-8 of a fix's variance.
const LOST: f64 = 1.0e5;

/// What the errors of fixes are, and what comes to those of the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Growth<T> {
    /// Variances of a fix \[m²\], \[rad²\].
    fix: (T, T),
    /// Of a base that has rested for long.
    rested: (T, T),
    /// Added from fix to fix at rest.
    rest: (T, T),
    /// Added per way \[m²/m\].
    per_way: T,
    /// Added per turn \[rad²/rad\].
    per_turn: T,
    /// Of the curvature bias of wheels of which nothing is learnt yet \[rad²/m²\], and added to it per way.
    bias: T,
    bias_per_way: T,
}

/// What odometry did since the last fix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Since<T> {
    /// In the world \[m\].
    pub(super) x: T,
    pub(super) y: T,
    /// Backward negative \[m\].
    pub(super) way: T,
    /// To either side \[rad\].
    pub(super) turn: T,
}

/// Covariance of the errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Covariance<T> {
    xx: T,
    xy: T,
    yy: T,
    xt: T,
    yt: T,
    tt: T,
    xb: T,
    yb: T,
    tb: T,
    bb: T,
}

/// What a fix corrects.
pub(super) struct Taken<T> {
    pub(super) pose: Pose<T>,
    /// \[rad/m\].
    pub(super) bias: T,
}

impl<T: Scalar> Growth<T> {
    /// For fixes of these standard deviations \[m\], \[rad\], of which a base at rest takes the shares `gain`; odometry that may be wrong by the share `drift`, and 2/l \[1/m\].
    ///
    /// The variance q that comes from fix to fix at rest is the one with which the filter settles at the share g: g σ² is left after
    /// a fix, g σ²/(1 − g) stands before it, so q = g² σ²/(1 − g).
    pub(super) fn new(fix: (T, T), gain: (T, T), drift: T, two_per_track: T) -> Self {
        let f = T::from_f64;
        let square = |value: T| value * value;
        let rest = |gain: T, noise: T| square(gain * noise) / (T::ONE - gain);
        let bias = square(f(RADII) * drift * two_per_track);
        Self {
            fix: (square(fix.0), square(fix.1)),
            rested: (gain.0 * square(fix.0), gain.1 * square(fix.1)),
            rest: (rest(gain.0, fix.0), rest(gain.1, fix.1)),
            per_way: square(f(PER_METRE) * drift),
            per_turn: square(f(PER_RADIAN) * drift),
            bias,
            bias_per_way: square(f(CHANGES)) * bias,
        }
    }

    /// Variance of a fix's heading \[rad²\].
    pub(super) const fn fix_heading(&self) -> T {
        self.fix.1
    }
}

impl<T: Scalar> Covariance<T> {
    /// Without fixes nobody asks.
    pub(super) const NONE: Self = Self {
        xx: T::ZERO,
        xy: T::ZERO,
        yy: T::ZERO,
        xt: T::ZERO,
        yt: T::ZERO,
        tt: T::ZERO,
        xb: T::ZERO,
        yb: T::ZERO,
        tb: T::ZERO,
        bb: T::ZERO,
    };

    /// Of a pose that is stated, of a base whose wheels nothing is known of.
    pub(super) fn stated(growth: &Growth<T>) -> Self {
        Self::of(growth.rested, growth.bias)
    }

    /// Of a pose that a fix set. What is known of the wheels stays.
    pub(super) fn set(&mut self, growth: &Growth<T>) {
        *self = Self::of(growth.fix, self.bb);
    }

    /// The same of a pose that is stated.
    pub(super) fn state(&mut self, growth: &Growth<T>) {
        *self = Self::of(growth.rested, self.bb);
    }

    fn of((position, heading): (T, T), bias: T) -> Self {
        let zero = T::ZERO;
        Self {
            xx: position,
            xy: zero,
            yy: position,
            xt: zero,
            yt: zero,
            tt: heading,
            xb: zero,
            yb: zero,
            tb: zero,
            bb: bias,
        }
    }

    /// P ← F P Fᵀ + Q. A heading that a gyro carries has the variance `carried`, and nothing to do with the wheels.
    pub(super) fn pass(&mut self, growth: &Growth<T>, since: &Since<T>, carried: Option<T>) {
        let zero = T::ZERO;
        let before = match carried {
            None => *self,
            Some(heading) => Self {
                tt: heading,
                xb: zero,
                yb: zero,
                tb: zero,
                ..*self
            },
        };
        let s = if carried.is_some() { zero } else { since.way };
        let Self { xt, yt, tt, .. } = before;
        let Self { xb, yb, tb, bb, .. } = before;
        let half = T::HALF * s;
        // Of the heading in the middle of the way, with x, y, the heading at its end, the bias, and itself.
        let (mx, my, mb) = (xt + half * xb, yt + half * yb, tb + half * bb);
        let next_tb = tb + s * bb;
        let mt = tt + s * tb + half * next_tb;
        let mm = tt + half * (tb + mb);
        let (ax, ay) = (-since.y, since.x);
        let way = since.way.abs();
        let slid = growth.rest.0 + growth.per_way * way;
        let (bias, most) = (bb + growth.bias_per_way * way, growth.bias);
        *self = Self {
            xx: before.xx + ax * (mx + mx + ax * mm) + slid,
            xy: before.xy + ax * my + ay * mx + ax * ay * mm,
            yy: before.yy + ay * (my + my + ay * mm) + slid,
            xt: xt + s * xb + ax * mt,
            yt: yt + s * yb + ay * mt,
            tt: match carried {
                None => tt + s * (tb + next_tb) + growth.rest.1 + growth.per_turn * since.turn,
                Some(heading) => heading,
            },
            xb: xb + ax * mb,
            yb: yb + ay * mb,
            tb: next_tb,
            bb: if bias < most { bias } else { most },
        };
        let (lost_m, lost_rad) = (
            T::from_f64(LOST) * growth.fix.0,
            T::from_f64(LOST) * growth.fix.1,
        );
        // Written so that what is not a number is lost.
        if !(self.xx + self.yy <= lost_m && self.tt <= lost_rad) {
            *self = Self::of((lost_m, lost_rad), self.bb);
        }
    }

    /// What is to be corrected for a fix that is off by so much, of errors that know nothing of each other: heading, x and y in turn.
    pub(super) fn take(&mut self, growth: &Growth<T>, off: &Pose<T>) -> Taken<T> {
        let (position, heading) = growth.fix;
        let mut taken = Taken {
            pose: Pose::default(),
            bias: T::ZERO,
        };
        let row = (self.xt, self.yt, self.tt, self.tb);
        self.see(&mut taken, row, self.tt + heading, off.theta);
        let row = (self.xx, self.xy, self.xt, self.xb);
        let left = off.x - taken.pose.x;
        self.see(&mut taken, row, self.xx + position, left);
        let row = (self.xy, self.yy, self.yt, self.yb);
        let left = off.y - taken.pose.y;
        self.see(&mut taken, row, self.yy + position, left);
        taken
    }

    /// K = P Hᵀ/(H P Hᵀ + r), P ← P − K H P, for a coordinate with the row (x, y, t, b) = H P, and `off` less than before by K off.
    #[inline(always)]
    fn see(&mut self, taken: &mut Taken<T>, (x, y, t, b): (T, T, T, T), sum: T, off: T) {
        let per = T::ONE / sum;
        let (kx, ky, kt, kb) = (x * per, y * per, t * per, b * per);
        taken.pose.x += kx * off;
        taken.pose.y += ky * off;
        taken.pose.theta += kt * off;
        taken.bias += kb * off;
        self.xx -= kx * x;
        self.xy -= kx * y;
        self.yy -= ky * y;
        self.xt -= kx * t;
        self.yt -= ky * t;
        self.tt -= kt * t;
        self.xb -= kx * b;
        self.yb -= ky * b;
        self.tb -= kt * b;
        self.bb -= kb * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fixes of 5 mm and 5 mrad and odometry that may be wrong by 2 %, on wheels 0.5 m apart.
    fn growth() -> Growth<f64> {
        Growth::new((5e-3, 5e-3), (0.04, 0.04), 0.02, 4.0)
    }

    /// A heading or a place of which nothing is known any more: no error has to do with another, and the next fix is taken whole.
    #[test]
    fn what_is_lost_is_taken_from_a_fix() {
        let growth = growth();
        let lost = Covariance::of((LOST * growth.fix.0, LOST * growth.fix.1), growth.bias);
        let since = |way, turn| Since {
            way,
            turn,
            ..Since::default()
        };
        // The bound is 2.5 m² and 2.5 rad². A radian adds 0.02²/3 rad², a metre twice (0.06 · 0.02)² m²: 18,750 and 870,000 of them.
        for (since, carried, is_lost) in [
            (since(0.0, 1.85e4), None, false),
            (since(0.0, 1.9e4), None, true),
            (since(8.5e5, 0.0), Some(1e-6), false),
            (since(8.8e5, 0.0), Some(1e-6), true),
            (since(0.0, f64::NAN), None, true),
        ] {
            let mut covariance = Covariance::stated(&growth);
            covariance.pass(&growth, &since, carried);
            assert_eq!(covariance == lost, is_lost, "{since:?}");
            let taken = covariance.take(&growth, &Pose::new(1.0, -2.0, 0.5)).pose;
            let left = [taken.x - 1.0, taken.y + 2.0, taken.theta - 0.5];
            // One of LOST of it is left, and of 2 m twice that.
            let whole = left.iter().all(|left| left.abs() < 2.0 / LOST);
            assert_eq!(whole, is_lost, "{since:?}: {left:?}");
        }
    }

    /// A heading that a gyro carries is as sure as the gyro says: that leads the place aside on the way, and tells nothing of the wheels.
    #[test]
    fn a_carried_heading_is_the_gyros() {
        let growth = growth();
        let mut covariance = Covariance::stated(&growth);
        // A metre along x, after some way by the wheels alone.
        let since = Since {
            x: 1.0,
            way: 1.0,
            ..Since::default()
        };
        covariance.pass(&growth, &since, None);
        assert!(covariance.yb > 0.0 && covariance.tb > 0.0);
        let (before, heading) = (covariance, 1e-6);
        covariance.pass(&growth, &since, Some(heading));
        let slid = growth.rest.0 + growth.per_way;
        let yy = before.yy + 2.0 * before.yt + heading + slid;
        for (is, expected) in [
            (covariance.xx, before.xx + slid),
            (covariance.yy, yy),
            (covariance.yt, before.yt + heading),
            (covariance.tt, heading),
            (covariance.yb, 0.0),
            (covariance.tb, 0.0),
        ] {
            // Roundings of some sums.
            assert!((is - expected).abs() < 1e-15, "{is:e} {expected:e}");
        }
    }
}
