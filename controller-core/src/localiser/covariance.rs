//! How far the believed pose may be off, and so what of a fix is to be taken: a Kalman filter of six states.
//!
//! True less believed are x, y, the heading θ, the curvature bias b, the turn that odometry has to add per way: wheels that
//! are not as large as stated, the turn bias e, what it has to add per turn: wheels that are not as far apart, and the tyres' slip κ, what they
//! slip per way and acceleration ([`slip`](crate::odometry::slip)). Over a chord (Δx, Δy) of the way s, on which the heading turned
//! by φ, and tyres that slip by 1 s²/m led the base aside by (a, b) and turned it by ψ,
//!
//! ```text
//! u = s δb + φ δe + ψ δκ          δx⁺ = δx − Δy (δθ + ½ u) + a δκ      δθ⁺ = δθ + u      δb⁺ = δb      δe⁺ = δe
//!                                 δy⁺ = δy + Δx (δθ + ½ u) + b δκ                        δκ⁺ = δκ
//! ```
//!
//! so that a fix beside the way tells of the heading, and a heading that is off of what it has led aside, of the wheels and of the tyres. What
//! comes to the errors is in [`Growth`]. A base that rests takes of each fix the share that its bandwidth states; one that
//! drives is less sure of where it is, and takes more.

use crate::odometry::Biases;
use crate::scalar::Scalar;
use crate::types::Pose;

/// Share of [`drift`](super::FusionParams::drift) by which radii of the right and the left wheel differ from what is stated, each
/// its way, as a standard deviation: 0.25 % of 2 %. Tyres that wear by up to a per cent, evenly spread and not the same on both
/// sides, have 1 %/√12 = 0.29 % each. The rest of the drift is for floors.
const RADII: f64 = 1.0 / 8.0;
/// What a bias changes by, as a share of that, over a metre or a radian: a load that moves, a tyre that warms, another floor. A third
/// in 10 m or 10 rad.
const CHANGES: f64 = 0.1;
/// Share of the drift that a metre is wrong by, as a standard deviation: 1.2 mm of 2 %, of tyres that slip and joints of floors.
const PER_METRE: f64 = 0.06;
/// Share of the drift that a turn of a radian is wrong by, as a standard deviation: 11.5 mrad of 2 %, a track that is wrong by up to the drift,
/// evenly: wide tyres roll about another point than is believed. √(1/3). So much is the same in every turn, the turn bias, and so much
/// is not: tyres that slip under the torque that turns a heavy base.
const PER_RADIAN: f64 = 0.577_350_269_189_625_8;
/// What the softest tyres slip per acceleration, over the drift \[s²/m\]: they lose all of it where they push with a fifth of what
/// they carry. At 2 % that is a stiffness of 10 times the load per unit of slip; tyres of cars have 10 to 30, hard wheels more.
pub(super) const SOFTEST: f64 = 1.0 / (0.2 * 9.81);
/// Share of that as a standard deviation, of what is evenly spread from rigid to the softest: √(1/12). It begins with rigid, which most
/// small wheels nearly are.
const SLIP: f64 = 0.288_675_134_594_812_9;
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
    /// Of the slip of their tyres \[s⁴/m²\]; 0 where nothing is learnt of it.
    slip: T,
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
    /// What tyres that slip by 1 s²/m did to that, beside what is corrected: in the world \[m²/s²\], and the turn \[rad m/s²\].
    pub(super) slip: Pose<T>,
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
    /// Of the curvature bias, the turn bias and the slip with the pose.
    b: WithPose<T>,
    e: WithPose<T>,
    k: WithPose<T>,
    /// And with each other.
    bb: T,
    be: T,
    bk: T,
    ee: T,
    ek: T,
    kk: T,
}

/// Covariances of an error with those of x, y and the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WithPose<T> {
    x: T,
    y: T,
    t: T,
}

/// What a fix corrects.
pub(super) struct Taken<T> {
    pub(super) pose: Pose<T>,
    pub(super) biases: Biases<T>,
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
            slip: T::ZERO,
        }
    }

    /// Tyres slip, of a base whose odometry may be wrong by the share `drift`.
    pub(super) fn learn_slip(&mut self, drift: T) {
        let slip = T::from_f64(SLIP * SOFTEST) * drift;
        self.slip = slip * slip;
    }

    /// Variance of a fix's heading \[rad²\].
    pub(super) const fn fix_heading(&self) -> T {
        self.fix.1
    }

    /// Variances of the curvature bias, the turn bias and the slip of wheels of which nothing is learnt yet.
    const fn unknown(&self) -> (T, T, T) {
        (self.curvature, self.per_turn, self.slip)
    }
}

impl<T: Scalar> WithPose<T> {
    const NONE: Self = Self {
        x: T::ZERO,
        y: T::ZERO,
        t: T::ZERO,
    };

    /// Beside a way aside of `(x, y)`, in whose middle the error has the covariance `middle` with the heading, and with the turn `turn`.
    fn passed(&self, way: (T, T), middle: T, turn: T) -> Self {
        Self {
            t: self.t + turn,
            ..self.led(way, middle)
        }
    }

    /// Led aside by `(x, y)` times an error with which this one has the covariance `with`.
    fn led(&self, (x, y): (T, T), with: T) -> Self {
        Self {
            x: self.x + x * with,
            y: self.y + y * with,
            t: self.t,
        }
    }

    fn subtract(&mut self, (x, y, t): (T, T, T), times: T) {
        self.x -= x * times;
        self.y -= y * times;
        self.t -= t * times;
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
        b: WithPose::NONE,
        e: WithPose::NONE,
        k: WithPose::NONE,
        bb: T::ZERO,
        be: T::ZERO,
        bk: T::ZERO,
        ee: T::ZERO,
        ek: T::ZERO,
        kk: T::ZERO,
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

    /// With these variances of the place and the heading. How well the wheels are known stays; that the biases have to do with each other
    /// is forgotten, so that all of the rest can be relied on whatever was there.
    fn restart(&mut self, pose: (T, T)) {
        *self = Self::of(pose, (self.bb, self.ee, self.kk));
    }

    fn of((position, heading): (T, T), (curvature, turn, slip): (T, T, T)) -> Self {
        Self {
            xx: position,
            yy: position,
            tt: heading,
            bb: curvature,
            ee: turn,
            kk: slip,
            ..Self::NONE
        }
    }

    /// P ← F P Fᵀ + Q. A heading that a gyro carries has the variance `carried`, and nothing to do with the wheels; where tyres slip to, it
    /// tells all the same.
    pub(super) fn pass(&mut self, growth: &Growth<T>, since: &Since<T>, carried: Option<T>) {
        let zero = T::ZERO;
        let (before, s, turn, slip) = match carried {
            None => (*self, since.way, since.turn, since.slip.theta),
            Some(heading) => {
                let before = Self {
                    tt: heading,
                    b: WithPose::NONE,
                    e: WithPose::NONE,
                    k: WithPose { t: zero, ..self.k },
                    ..*self
                };
                (before, zero, zero, zero)
            }
        };
        let Self {
            xt,
            yt,
            tt,
            b,
            e,
            k,
            ..
        } = before;
        let Self {
            bb,
            be,
            bk,
            ee,
            ek,
            kk,
            ..
        } = before;
        // Of u with x, y, the heading, the biases, and itself.
        let of_turn = |b: T, e: T, k: T| s * b + turn * e + slip * k;
        let (ux, uy, ut) = (
            of_turn(b.x, e.x, k.x),
            of_turn(b.y, e.y, k.y),
            of_turn(b.t, e.t, k.t),
        );
        let (ub, ue, uk) = (
            of_turn(bb, be, bk),
            of_turn(be, ee, ek),
            of_turn(bk, ek, kk),
        );
        let uu = of_turn(ub, ue, uk);
        // Of the heading in the middle of the way with x, y, the biases, itself, and the heading at the end.
        let half = T::HALF;
        let (mx, my) = (xt + half * ux, yt + half * uy);
        let (mb, me, mk) = (b.t + half * ub, e.t + half * ue, k.t + half * uk);
        let mm = tt + ut + half * (half * uu);
        let mt = mm + half * (ut + half * uu);
        let aside = (-since.y, since.x);
        let (ax, ay) = aside;
        let slid = (since.slip.x, since.slip.y);
        let (sx, sy) = slid;
        // Of the slip before and after what it leads aside.
        let led = k.passed(aside, mk, uk);
        let k = led.led(slid, kk);
        let way = since.way.abs();
        let chance = growth.rest.0 + growth.per_way * way;
        let turned = since.turn.abs();
        let changes = T::from_f64(CHANGES * CHANGES);
        let changed = |variance: T, most: T, over: T| {
            let more = variance + changes * most * over;
            if more < most { more } else { most }
        };
        *self = Self {
            xx: before.xx + ax * (mx + mx + ax * mm) + sx * (led.x + k.x) + chance,
            xy: before.xy + ax * my + ay * mx + ax * ay * mm + sx * k.y + sy * led.x,
            yy: before.yy + ay * (my + my + ay * mm) + sy * (led.y + k.y) + chance,
            xt: xt + ux + ax * mt + sx * k.t,
            yt: yt + uy + ay * mt + sy * k.t,
            tt: match carried {
                None => tt + ut + ut + uu + growth.rest.1 + growth.per_turn * turned,
                Some(heading) => heading,
            },
            b: b.passed(aside, mb, ub).led(slid, bk),
            e: e.passed(aside, me, ue).led(slid, ek),
            k,
            bb: changed(bb, growth.curvature, way),
            be,
            bk,
            ee: changed(ee, growth.per_turn, turned),
            ek,
            kk: changed(kk, growth.slip, way),
        };
        self.keep_or_lose(growth);
    }

    /// Beyond [`LOST`] nothing is known of the pose.
    #[inline(always)]
    fn keep_or_lose(&mut self, growth: &Growth<T>) {
        let (lost_m, lost_rad) = (
            T::from_f64(LOST) * growth.fix.0,
            T::from_f64(LOST) * growth.fix.1,
        );
        // Written so that what is not a number is lost.
        if !(self.xx + self.yy <= lost_m && self.tt <= lost_rad) {
            self.restart((lost_m, lost_rad));
        }
    }

    /// Variances of the innovations of a fix of x, y and the heading.
    pub(super) fn innovations(&self, growth: &Growth<T>) -> (T, T, T) {
        let (position, heading) = growth.fix;
        (self.xx + position, self.yy + position, self.tt + heading)
    }

    /// The pose is more off than was known, by these variances: of x, y and the heading.
    pub(super) fn widen(&mut self, growth: &Growth<T>, (x, y, heading): (T, T, T)) {
        self.xx += x;
        self.yy += y;
        self.tt += heading;
        self.keep_or_lose(growth);
    }

    /// What is to be corrected for a fix that is off by so much, of errors that know nothing of each other: heading, x and y in turn.
    pub(super) fn take(&mut self, growth: &Growth<T>, off: &Pose<T>) -> Taken<T> {
        let (position, heading) = growth.fix;
        let mut taken = Taken {
            pose: Pose::default(),
            biases: Biases::NONE,
        };
        let pose = (self.xt, self.yt, self.tt);
        let biases = (self.b.t, self.e.t, self.k.t);
        self.see(&mut taken, pose, biases, self.tt + heading, off.theta);
        let pose = (self.xx, self.xy, self.xt);
        let biases = (self.b.x, self.e.x, self.k.x);
        let left = off.x - taken.pose.x;
        self.see(&mut taken, pose, biases, self.xx + position, left);
        let pose = (self.xy, self.yy, self.yt);
        let biases = (self.b.y, self.e.y, self.k.y);
        let left = off.y - taken.pose.y;
        self.see(&mut taken, pose, biases, self.yy + position, left);
        taken
    }

    /// K = P Hᵀ/(H P Hᵀ + r), P ← P − K H P, for a coordinate with the row (x, y, t), (b, e, k) = H P, and `off` less than before by K off.
    #[inline(always)]
    fn see(
        &mut self,
        taken: &mut Taken<T>,
        (x, y, t): (T, T, T),
        (b, e, k): (T, T, T),
        sum: T,
        off: T,
    ) {
        let per = T::ONE / sum;
        let gain = (x * per, y * per, t * per);
        let (gx, gy, gt) = gain;
        let (gb, ge, gk) = (b * per, e * per, k * per);
        taken.pose.x += gx * off;
        taken.pose.y += gy * off;
        taken.pose.theta += gt * off;
        taken.biases.per_way += gb * off;
        taken.biases.per_turn += ge * off;
        taken.biases.slip += gk * off;
        self.xx -= gx * x;
        self.xy -= gx * y;
        self.yy -= gy * y;
        self.xt -= gx * t;
        self.yt -= gy * t;
        self.tt -= gt * t;
        self.b.subtract(gain, b);
        self.e.subtract(gain, e);
        self.k.subtract(gain, k);
        self.bb -= gb * b;
        self.be -= gb * e;
        self.bk -= gb * k;
        self.ee -= ge * e;
        self.ek -= ge * k;
        self.kk -= gk * k;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fixes of 5 mm and 5 mrad and odometry that may be wrong by 2 %, on wheels 0.5 m apart.
    fn growth() -> Growth<f64> {
        Growth::new((5e-3, 5e-3), (0.04, 0.04), 0.02, 4.0)
    }

    /// x, y, heading, curvature bias, turn bias, slip.
    type Matrix = [[f64; 6]; 6];

    /// Of every pair of errors.
    fn whole(p: &Covariance<f64>) -> Matrix {
        let Covariance { b, e, k, .. } = p;
        [
            [p.xx, p.xy, p.xt, b.x, e.x, k.x],
            [p.xy, p.yy, p.yt, b.y, e.y, k.y],
            [p.xt, p.yt, p.tt, b.t, e.t, k.t],
            [b.x, b.y, b.t, p.bb, p.be, p.bk],
            [e.x, e.y, e.t, p.be, p.ee, p.ek],
            [k.x, k.y, k.t, p.bk, p.ek, p.kk],
        ]
    }

    /// Some covariance in which all errors have to do with each other: A Aᵀ, a tenth of the largest variances that biases may have.
    fn some(growth: &Growth<f64>, seed: u32) -> Covariance<f64> {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX) - 0.5
        };
        let a: Matrix = core::array::from_fn(|_| core::array::from_fn(|_| random()));
        let (curvature, turn, slip) = growth.unknown();
        let sizes =
            [1e-4, 1e-4, 1e-4, curvature, turn, slip].map(|variance| (0.1 * variance).sqrt());
        let p = |i: usize, j: usize| {
            let product: f64 = (0..6).map(|n| a[i][n] * a[j][n]).sum();
            sizes[i] * sizes[j] * product
        };
        let with_pose = |i: usize| WithPose {
            x: p(0, i),
            y: p(1, i),
            t: p(2, i),
        };
        Covariance {
            xx: p(0, 0),
            xy: p(0, 1),
            yy: p(1, 1),
            xt: p(0, 2),
            yt: p(1, 2),
            tt: p(2, 2),
            b: with_pose(3),
            e: with_pose(4),
            k: with_pose(5),
            bb: p(3, 3),
            be: p(3, 4),
            bk: p(3, 5),
            ee: p(4, 4),
            ek: p(4, 5),
            kk: p(5, 5),
        }
    }

    fn assert_close(is: &Covariance<f64>, expected: &Matrix) {
        let is = whole(is);
        for (i, row) in expected.iter().enumerate() {
            for (j, expected) in row.iter().enumerate() {
                // Roundings of some sums, of the size of the errors themselves.
                let size = (is[i][i] * is[j][j]).sqrt();
                assert!((is[i][j] - expected).abs() <= 1e-13 * size, "{i} {j}");
            }
        }
    }

    /// The table of the head of this file, as a matrix: P ← F P Fᵀ + Q.
    #[test]
    fn errors_pass_as_the_table_says() {
        let mut growth = growth();
        growth.learn_slip(0.02);
        for seed in 0..40 {
            let before = some(&growth, seed);
            let back = if seed % 2 == 0 { 1.0 } else { -1.0 };
            let since = Since {
                x: 0.7,
                y: -0.4,
                way: 0.9 * back,
                turn: -0.6 * back,
                slip: Pose::new(-0.3, 0.5, 0.8),
            };
            for carried in [None, Some(3e-5)] {
                let mut p = whole(&before);
                let mut u = [0.0, 0.0, 0.0, since.way, since.turn, since.slip.theta];
                if let Some(heading) = carried {
                    // Neither the heading nor what turns it has to do with the wheels.
                    u = [0.0; 6];
                    p[2][2] = heading;
                    for (a, b) in [(0, 3), (1, 3), (2, 3), (0, 4), (1, 4), (2, 4), (2, 5)] {
                        (p[a][b], p[b][a]) = (0.0, 0.0);
                    }
                }
                let mut f: Matrix =
                    core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
                for j in 0..6 {
                    let middle = f[2][j] + 0.5 * u[j];
                    f[0][j] -= since.y * middle;
                    f[1][j] += since.x * middle;
                }
                for j in 0..6 {
                    f[2][j] += u[j];
                }
                f[0][5] += since.slip.x;
                f[1][5] += since.slip.y;
                let fp: Matrix = core::array::from_fn(|i| {
                    core::array::from_fn(|j| (0..6).map(|n| f[i][n] * p[n][j]).sum())
                });
                let mut after: Matrix = core::array::from_fn(|i| {
                    core::array::from_fn(|j| (0..6).map(|n| fp[i][n] * f[j][n]).sum())
                });
                let (curvature, turn, slip) = growth.unknown();
                for place in [0, 1] {
                    after[place][place] += growth.rest.0 + 0.9 * growth.per_way;
                }
                if carried.is_none() {
                    after[2][2] += growth.rest.1 + 0.6 * growth.per_turn;
                }
                // A hundredth over a metre or a radian.
                after[3][3] += 0.01 * 0.9 * curvature;
                after[4][4] += 0.01 * 0.6 * turn;
                after[5][5] += 0.01 * 0.9 * slip;
                let mut covariance = before;
                covariance.pass(&growth, &since, carried);
                assert_close(&covariance, &after);
            }
        }
    }

    /// No bias is less known than that of wheels of which nothing is learnt.
    #[test]
    fn biases_change_up_to_what_is_unknown() {
        let mut growth = growth();
        growth.learn_slip(0.02);
        let mut covariance = some(&growth, 1);
        let since = Since {
            way: -200.0,
            turn: -200.0,
            ..Since::default()
        };
        covariance.pass(&growth, &since, None);
        let found = (covariance.bb, covariance.ee, covariance.kk);
        assert_eq!(found, growth.unknown());
        // An eighth of 2 % on either side of half a metre; the square root of a third; twelfth of what the softest slip.
        let stated = [found.0, found.1, found.2].map(f64::sqrt);
        let expected = [
            0.01,
            0.02 / 3.0_f64.sqrt(),
            0.02 / (0.2 * 9.81) / 12.0_f64.sqrt(),
        ];
        for (stated, expected) in stated.iter().zip(expected) {
            assert!(
                (stated / expected - 1.0).abs() < 1e-12,
                "{stated} {expected}"
            );
        }
    }

    /// Kalman's formula, of a heading, an x and a y in turn, each of what the ones before have left.
    #[test]
    fn a_fix_is_taken_as_kalman_says() {
        let mut growth = Growth::new((5e-3, 8e-3), (0.04, 0.04), 0.02, 4.0);
        growth.learn_slip(0.02);
        let (position, heading) = growth.fix;
        assert_eq!(growth.fix_heading(), 8e-3 * 8e-3);
        for seed in 0..40 {
            let mut covariance = some(&growth, seed);
            let off = Pose::new(0.02, -0.03, 0.01);
            let (mut p, mut expected) = (whole(&covariance), [0.0; 6]);
            for (n, off, noise) in [
                (2, off.theta, heading),
                (0, off.x, position),
                (1, off.y, position),
            ] {
                let gain = p[n].map(|with| with / (p[n][n] + noise));
                let left = off - expected[n];
                let seen = p[n];
                for i in 0..6 {
                    expected[i] += gain[i] * left;
                    for j in 0..6 {
                        p[i][j] -= gain[i] * seen[j];
                    }
                }
            }
            let Taken { pose, biases } = covariance.take(&growth, &off);
            let taken = [
                pose.x,
                pose.y,
                pose.theta,
                biases.per_way,
                biases.per_turn,
                biases.slip,
            ];
            for (taken, expected) in taken.iter().zip(expected) {
                assert!(
                    (taken - expected).abs() < 1e-15,
                    "{seed}: {taken:e} {expected:e}"
                );
            }
            assert_close(&covariance, &p);
        }
    }

    /// At rest as much of each fix is taken as is stated, and what is left is what a stated pose has.
    #[test]
    fn a_base_at_rest_takes_the_stated_share() {
        let growth = Growth::new((5e-3, 8e-3), (0.04, 0.1), 0.02, 4.0);
        let stated = Covariance::stated(&growth);
        let mut covariance = stated;
        covariance.pass(&growth, &Since::default(), None);
        let taken = covariance.take(&growth, &Pose::new(1.0, -1.0, 1.0)).pose;
        let shares = [taken.x - 0.04, taken.y + 0.04, taken.theta - 0.1];
        assert!(shares.iter().all(|off| off.abs() < 1e-12), "{shares:?}");
        assert_close(&covariance, &whole(&stated));
    }

    /// What is known of the wheels stays, and that it has to do with the pose is forgotten.
    #[test]
    fn a_pose_that_is_set_forgets_the_pose_alone() {
        let mut growth = Growth::new((5e-3, 8e-3), (0.04, 0.1), 0.02, 4.0);
        growth.learn_slip(0.02);
        let before = some(&growth, 3);
        let (mut set, mut stated) = (before, before);
        set.set(&growth);
        stated.state(&growth);
        let square = |value: f64| value * value;
        for (covariance, place, heading) in [
            (set, square(5e-3), square(8e-3)),
            (stated, 0.04 * square(5e-3), 0.1 * square(8e-3)),
        ] {
            let mut expected = [[0.0; 6]; 6];
            for (n, variance) in [place, place, heading, before.bb, before.ee, before.kk]
                .into_iter()
                .enumerate()
            {
                expected[n][n] = variance;
            }
            assert_eq!(whole(&covariance), expected);
        }
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

    /// A heading that a gyro carries is as sure as the gyro says: that leads the place aside on the way, and tells nothing of the wheels. What
    /// tyres lead aside shows in the place all the same.
    #[test]
    fn a_carried_heading_is_the_gyros() {
        let mut growth = growth();
        growth.learn_slip(0.02);
        let mut covariance = Covariance::stated(&growth);
        // A metre along x, on which the heading turns by half a radian, after the same by the wheels alone.
        let since = Since {
            x: 1.0,
            way: 1.0,
            turn: 0.5,
            slip: Pose::new(0.0, -0.1, 0.2),
            ..Since::default()
        };
        covariance.pass(&growth, &since, None);
        let learnt = [
            covariance.b.y,
            covariance.b.t,
            covariance.e.y,
            covariance.e.t,
            covariance.k.t,
        ];
        assert!(learnt.iter().all(|&with| with > 0.0), "{learnt:?}");
        let (before, heading) = (covariance, 1e-6);
        covariance.pass(&growth, &since, Some(heading));
        let slid = growth.rest.0 + growth.per_way;
        // A tenth of the slip comes aside, to the right, with what was aside before.
        let (kk, ky) = (before.kk, before.k.y);
        let led = 0.01 * kk - 2.0 * 0.1 * ky;
        let yy = before.yy + 2.0 * before.yt + heading + slid + led;
        for (is, expected) in [
            (covariance.xx, before.xx + slid),
            (covariance.yy, yy),
            (covariance.yt, before.yt + heading),
            (covariance.k.y, ky - 0.1 * kk),
            (covariance.k.t, 0.0),
            (covariance.tt, heading),
            (covariance.b.y, 0.0),
            (covariance.b.t, 0.0),
            (covariance.e.y, 0.0),
            (covariance.e.t, 0.0),
        ] {
            // Roundings of some sums.
            assert!((is - expected).abs() < 1e-15, "{is:e} {expected:e}");
        }
    }
}
