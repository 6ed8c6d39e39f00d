//! How far the believed pose may be off, and so what of a fix is to be taken: a Kalman filter of five states.
//!
//! True less believed are x, y, the heading θ, the curvature bias b, the turn that odometry has to add per way: wheels that
//! are not as large as stated, and the turn bias e, what it has to add per turn: wheels that are not as far apart. Over a chord (Δx, Δy)
//! of the way s, on which the heading turned by φ,
//!
//! ```text
//! u = s δb + φ δe          δx⁺ = δx − Δy (δθ + ½ u)      δθ⁺ = δθ + u      δb⁺ = δb
//!                          δy⁺ = δy + Δx (δθ + ½ u)                        δe⁺ = δe
//! ```
//!
//! so that a fix beside the way tells of the heading, and a heading that is off of what it has led aside and of the wheels. What
//! comes to the errors is in [`Growth`]. A base that rests takes of each fix the share that its bandwidth states; one that
//! drives is less sure of where it is, and takes more.

use crate::odometry::TurnBias;
use crate::scalar::Scalar;
use crate::types::Pose;

/// Share of [`drift`](super::FusionParams::drift) by which radii of the right and the left wheel differ from what is stated, each
/// its way, as a standard deviation: 0.25 % of 2 %. Tyres that wear by up to a per cent, evenly spread and not the same on both
/// sides, have 1 %/√12 = 0.29 % each. The rest of the drift is for floors.
const RADII: f64 = 1.0 / 8.0;
/// What either bias changes by, as a share of that, over a metre or a radian: a load that moves, a tyre that warms, another floor. A third
/// in 10 m or 10 rad.
const CHANGES: f64 = 0.1;
/// Share of the drift that a metre is wrong by, as a standard deviation: 1.2 mm of 2 %, of tyres that slip and joints of floors.
const PER_METRE: f64 = 0.06;
/// Share of the drift that a turn of a radian is wrong by, as a standard deviation: 11.5 mrad of 2 %, a track that is wrong by up to the drift,
/// evenly: wide tyres roll about another point than is believed. √(1/3). So much is the same in every turn, the turn bias, and so much
/// is not: tyres that slip under the torque that turns a heavy base.
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
    /// Added per turn \[rad²/rad\], and of the turn bias of wheels of which nothing is learnt yet.
    per_turn: T,
    /// Of the curvature bias of these \[rad²/m²\].
    curvature: T,
}

/// What odometry did since the last fix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Since<T> {
    /// In the world \[m\].
    pub(super) x: T,
    pub(super) y: T,
    /// Backward negative \[m\].
    pub(super) way: T,
    /// Counter-clockwise positive \[rad\].
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
    xe: T,
    ye: T,
    te: T,
    be: T,
    ee: T,
}

/// What a fix corrects.
pub(super) struct Taken<T> {
    pub(super) pose: Pose<T>,
    pub(super) bias: TurnBias<T>,
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
        Self {
            fix: (square(fix.0), square(fix.1)),
            rested: (gain.0 * square(fix.0), gain.1 * square(fix.1)),
            rest: (rest(gain.0, fix.0), rest(gain.1, fix.1)),
            per_way: square(f(PER_METRE) * drift),
            per_turn: square(f(PER_RADIAN) * drift),
            curvature: square(f(RADII) * drift * two_per_track),
        }
    }

    /// Variance of a fix's heading \[rad²\].
    pub(super) const fn fix_heading(&self) -> T {
        self.fix.1
    }

    /// Variances of the curvature bias and of the turn bias of wheels of which nothing is learnt yet.
    const fn unknown(&self) -> (T, T) {
        (self.curvature, self.per_turn)
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
        xe: T::ZERO,
        ye: T::ZERO,
        te: T::ZERO,
        be: T::ZERO,
        ee: T::ZERO,
    };

    /// Of a pose that is stated, of a base whose wheels nothing is known of.
    pub(super) fn stated(growth: &Growth<T>) -> Self {
        Self::of(growth.rested, growth.unknown())
    }

    /// Of a pose that a fix set. What is known of the wheels stays.
    pub(super) fn set(&mut self, growth: &Growth<T>) {
        self.restart(growth.fix);
    }

    /// The same of a pose that is stated.
    pub(super) fn state(&mut self, growth: &Growth<T>) {
        self.restart(growth.rested);
    }

    /// With these variances of the place and the heading. How well the wheels are known stays; that the two biases have to do with each other
    /// is forgotten, so that all of the rest can be relied on whatever was there.
    fn restart(&mut self, pose: (T, T)) {
        *self = Self::of(pose, (self.bb, self.ee));
    }

    fn of((position, heading): (T, T), (curvature, turn): (T, T)) -> Self {
        Self {
            xx: position,
            yy: position,
            tt: heading,
            bb: curvature,
            ee: turn,
            ..Self::NONE
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
                xe: zero,
                ye: zero,
                te: zero,
                ..*self
            },
        };
        let (s, turn) = match carried {
            None => (since.way, since.turn),
            Some(_) => (zero, zero),
        };
        let Self { xt, yt, tt, .. } = before;
        let Self { xb, yb, tb, bb, .. } = before;
        let Self {
            xe, ye, te, be, ee, ..
        } = before;
        // Of u with x, y, the heading, the biases, and itself.
        let of_turn = |bias: T, per_turn: T| s * bias + turn * per_turn;
        let (ux, uy, ut) = (of_turn(xb, xe), of_turn(yb, ye), of_turn(tb, te));
        let (ub, ue) = (of_turn(bb, be), of_turn(be, ee));
        let uu = of_turn(ub, ue);
        // Of the heading in the middle of the way with x, y, the biases, itself, and the heading at the end.
        let half = T::HALF;
        let (mx, my) = (xt + half * ux, yt + half * uy);
        let (mb, me) = (tb + half * ub, te + half * ue);
        let mm = tt + ut + half * (half * uu);
        let mt = mm + half * (ut + half * uu);
        let (ax, ay) = (-since.y, since.x);
        let way = since.way.abs();
        let slid = growth.rest.0 + growth.per_way * way;
        let turned = since.turn.abs();
        let changes = T::from_f64(CHANGES * CHANGES);
        let changed = |variance: T, most: T, over: T| {
            let more = variance + changes * most * over;
            if more < most { more } else { most }
        };
        *self = Self {
            xx: before.xx + ax * (mx + mx + ax * mm) + slid,
            xy: before.xy + ax * my + ay * mx + ax * ay * mm,
            yy: before.yy + ay * (my + my + ay * mm) + slid,
            xt: xt + ux + ax * mt,
            yt: yt + uy + ay * mt,
            tt: match carried {
                None => tt + ut + ut + uu + growth.rest.1 + growth.per_turn * turned,
                Some(heading) => heading,
            },
            xb: xb + ax * mb,
            yb: yb + ay * mb,
            tb: tb + ub,
            bb: changed(bb, growth.curvature, way),
            xe: xe + ax * me,
            ye: ye + ay * me,
            te: te + ue,
            be,
            ee: changed(ee, growth.per_turn, turned),
        };
        let (lost_m, lost_rad) = (
            T::from_f64(LOST) * growth.fix.0,
            T::from_f64(LOST) * growth.fix.1,
        );
        // Written so that what is not a number is lost.
        if !(self.xx + self.yy <= lost_m && self.tt <= lost_rad) {
            self.restart((lost_m, lost_rad));
        }
    }

    /// What is to be corrected for a fix that is off by so much, of errors that know nothing of each other: heading, x and y in turn.
    pub(super) fn take(&mut self, growth: &Growth<T>, off: &Pose<T>) -> Taken<T> {
        let (position, heading) = growth.fix;
        let mut taken = Taken {
            pose: Pose::default(),
            bias: TurnBias::NONE,
        };
        let row = (self.xt, self.yt, self.tt, self.tb, self.te);
        self.see(&mut taken, row, self.tt + heading, off.theta);
        let row = (self.xx, self.xy, self.xt, self.xb, self.xe);
        let left = off.x - taken.pose.x;
        self.see(&mut taken, row, self.xx + position, left);
        let row = (self.xy, self.yy, self.yt, self.yb, self.ye);
        let left = off.y - taken.pose.y;
        self.see(&mut taken, row, self.yy + position, left);
        taken
    }

    /// K = P Hᵀ/(H P Hᵀ + r), P ← P − K H P, for a coordinate with the row (x, y, t, b, e) = H P, and `off` less than before by K off.
    #[inline(always)]
    fn see(&mut self, taken: &mut Taken<T>, (x, y, t, b, e): (T, T, T, T, T), sum: T, off: T) {
        let per = T::ONE / sum;
        let (kx, ky, kt, kb, ke) = (x * per, y * per, t * per, b * per, e * per);
        taken.pose.x += kx * off;
        taken.pose.y += ky * off;
        taken.pose.theta += kt * off;
        taken.bias.per_way += kb * off;
        taken.bias.per_turn += ke * off;
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
        self.xe -= kx * e;
        self.ye -= ky * e;
        self.te -= kt * e;
        self.be -= kb * e;
        self.ee -= ke * e;
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
        let lost = Covariance::of((LOST * growth.fix.0, LOST * growth.fix.1), growth.unknown());
        let since = |way, turn| Since {
            way,
            turn,
            ..Since::default()
        };
        // The bound is 2.5 m² and 2.5 rad². φ radians add 0.02²/3 (φ + φ²) rad², a metre twice (0.06 · 0.02)² m²: 136.4 and 870,000 of them.
        for (since, carried, is_lost) in [
            (since(0.0, 136.0), None, false),
            (since(0.0, -137.0), None, true),
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
        // A metre along x, on which the heading turns by half a radian, after the same by the wheels alone.
        let since = Since {
            x: 1.0,
            way: 1.0,
            turn: 0.5,
            ..Since::default()
        };
        covariance.pass(&growth, &since, None);
        let learnt = [covariance.yb, covariance.tb, covariance.ye, covariance.te];
        assert!(learnt.iter().all(|&with| with > 0.0), "{learnt:?}");
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
            (covariance.ye, 0.0),
            (covariance.te, 0.0),
        ] {
            // Roundings of some sums.
            assert!((is - expected).abs() < 1e-15, "{is:e} {expected:e}");
        }
    }
}
