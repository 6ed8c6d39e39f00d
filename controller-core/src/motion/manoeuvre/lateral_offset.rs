//! What a robot is aside of its manoeuvre, worked off by the goal.
//!
//! A manoeuvre is driven as planned, and what the robot lacks of it is the follower's: in the second that the last drive takes, its lateral
//! feedback, which noise and delays keep soft, works off a half. So the reference goes to where the robot is, and from there along a
//! curve that joins the planned one at the goal: what the robot has to turn for it is fed forward.

use super::candidate::PlanLimits;
use crate::motion::limits::rim_speed;
use crate::range::{clamp, larger, signed};
use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// Time between two settings of the offset \[s\]: a fix or two, and no less than the follower's neurons need to answer the last one
/// (1/A, 0.05 to 0.2 s). In every tick, it would answer its own corrections, and weave.
pub(crate) const SETTING_S: f64 = 0.1;

/// The driven reference lies z to the left of the planned one:
///
/// ```text
/// z(w) = z₀ + z₁ w + z₂ w² + c₃ w³ + c₄ w⁴ + h w³ (1 − w)²        w = 1 − q/q₀        z(1) = z′(1) = 0
/// c₃ = −4 z₀ − 3 z₁ − 2 z₂                                        c₄ = 3 z₀ + 2 z₁ + z₂
/// ```
///
/// | symbol | what | unit |
/// | --- | --- | --- |
/// | q, q₀ | distance left of the last drive, now and where z was set | m |
/// | z₀, z₁, z₂ | offset there, its first derivative and half its second by w | m |
/// | c₃ + h | a sixth of its third | m |
///
/// z₁, z₂ and h are those of the curve until then: heading and turn rate of the reference do not jump, its place does. Of a robot
/// that begins on the way all of them are its own, the angular acceleration by h; else h is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LateralOffset<T> {
    /// q₀; 0 where there is no offset.
    from: T,
    /// z₀, z₁, z₂, c₃ + h, c₄ − 2 h and h: what z has of the powers of w.
    powers: [T; 6],
}

/// A robot beside a straight path that it drives along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aside<T> {
    /// To the left of the path \[m\].
    pub(crate) offset: T,
    /// Tangent of its heading against that of the path.
    pub(crate) slope: T,
    /// Of its heading \[rad/s\], and the rate of that \[rad/s²\].
    pub(crate) turn_rate: T,
    pub(crate) turn_accel: T,
    /// Speed along the path \[m/s\], and its rate \[m/s²\].
    pub(crate) speed: T,
    pub(crate) accel: T,
}

/// What a reference that is moved aside does, less what it would do otherwise.
pub(crate) struct Beside<T> {
    /// z \[m\].
    pub(crate) offset: T,
    /// z′.
    pub(crate) slope: T,
    /// It looks to the right of the path by this \[rad\].
    pub(crate) turned: T,
    pub(crate) twist: Twist<T>,
    pub(crate) accel: Accel<T>,
}

/// The largest slope that a curve begins with: then its heading and its length are known to a thousandth from powers of the slope.
pub(crate) const STEEPEST: f64 = 0.2;

/// What setting an offset may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OffsetLimits<T> {
    /// Angular acceleration that the plan has left \[rad/s²\].
    pub(crate) turn_accel: T,
    /// With which the last drive speeds up \[m/s²\].
    pub(crate) drive_accel: T,
    /// Gain of the follower's heading, k₃ \[1/s\].
    pub(crate) heading: T,
    /// What is less is not worth a turn \[m\].
    pub(crate) least: T,
}

/// z and its derivatives by q.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OffsetSample<T> {
    pub(crate) offset: T,
    pub(crate) first: T,
    pub(crate) second: T,
    pub(crate) third: T,
}

impl<T: Scalar> LateralOffset<T> {
    /// On the path itself.
    pub(crate) const NONE: Self = Self {
        from: T::ZERO,
        powers: [T::ZERO; 6],
    };

    /// From z₀, z₁, z₂ and h.
    fn new(from: T, [a, b, c]: [T; 3], swell: T) -> Self {
        let f = T::from_f64;
        let third = swell - straight_third([a, b, c]);
        let fourth = f(3.0) * a + f(2.0) * b + c - f(2.0) * swell;
        Self {
            from,
            powers: [a, b, c, third, fourth, swell],
        }
    }

    /// There is one.
    pub(crate) fn is_set(&self) -> bool {
        self.from > T::ZERO
    }

    /// z, z′, z″/2 and z‴/6 by w.
    fn by_share(&self, w: T) -> [T; 4] {
        // Horner's scheme divides by (x − w): the remainder is the value there, and that of the quotient the derivative.
        let [mut a, mut b, mut c, mut d, mut e, h] = self.powers;
        e += w * h;
        d += w * e;
        c += w * d;
        b += w * c;
        a += w * b;
        e += w * h;
        d += w * e;
        c += w * d;
        b += w * c;
        e += w * h;
        d += w * e;
        c += w * d;
        e += w * h;
        d += w * e;
        [a, b, c, d]
    }

    /// With `left` still to drive.
    pub(crate) fn at(&self, left: T) -> OffsetSample<T> {
        if !self.is_set() {
            return OffsetSample::default();
        }
        let per = T::ONE / self.from;
        let [offset, first, second, third] = self.by_share(T::ONE - left * per);
        let two = T::from_f64(2.0) * per * per;
        OffsetSample {
            offset,
            first: -(first * per),
            second: two * second,
            third: -(T::from_f64(3.0) * two * per * third),
        }
    }

    /// The curve from `offset` on, with `left` > 0 to drive at `speed`; the same as before where that is as good, or where it is too late
    /// for another.
    ///
    /// Too late is when less than 1/k₃ is left, which braking evenly takes 2 q/|v| of: the heading would not be back at the goal. What
    /// the curve asks for at its begin, 6 |c₃| v²/q³, has to be there, or to be asked for already: z₀ is as much of `offset` as it is. v
    /// is what is driven, or what will be where the drive has just begun, √(a q).
    pub(crate) fn set(&self, limits: &OffsetLimits<T>, left: T, speed: T, offset: T) -> Self {
        let f = T::from_f64;
        let (share, [now, first, second, third]) = if self.is_set() {
            let share = left / self.from;
            (share, self.by_share(T::ONE - share))
        } else {
            (T::ZERO, [T::ZERO; 4])
        };
        let change = offset - now;
        if change.abs() <= limits.least || f(2.0) * left * limits.heading <= speed.abs() {
            return *self;
        }
        // By the share of the way that is left: the curve that is left, z₀ apart.
        let (square, cube) = (share * share, share * share * share);
        let [.., swell] = self.powers;
        let (first, second, third) = (share * first, square * second, cube * third);
        let swell = square * cube * swell;
        let fast = larger(speed * speed, limits.drive_accel * left);
        let allowed = limits.turn_accel * left * left * left / (f(6.0) * fast);
        let most = larger(allowed, third.abs());
        let rest = f(3.0) * first + f(2.0) * second - swell;
        let third = clamp(-(f(4.0) * offset + rest), most);
        Self::new(left, [f(-0.25) * (third + rest), first, second], swell)
    }

    /// What a reference of speed v, turn rate w and acceleration `accel` that is moved aside does otherwise, with `left` to drive.
    ///
    /// With z, z′, z″, z‴ by the distance q that is left, q̇ = −|v|:
    ///
    /// ```text
    /// ψ = −sgn(v) atan z′        ψ̇ = v z″/(1 + z′²)        v ← v √(1 + z′²) − z w        d/dt of both
    /// ```
    ///
    /// to the third power of z′, of which there is no more than [`STEEPEST`]: what is left out is below a thousandth.
    #[inline(always)]
    pub(crate) fn beside(&self, left: T, twist: &Twist<T>, accel: T) -> Beside<T> {
        let v = twist.linear;
        let now = self.at(left);
        let third = T::from_f64(1.0 / 3.0);
        let square = now.first * now.first;
        let (longer, less) = (T::HALF * square, T::ONE - square);
        let steep = now.first * (T::ONE - third * square);
        let passing = v * v.abs();
        let pulled = now.first * now.second;
        Beside {
            offset: now.offset,
            slope: now.first,
            turned: signed(steep, v),
            twist: Twist {
                linear: longer * v - now.offset * twist.angular,
                angular: v * less * now.second,
            },
            accel: Accel {
                linear: longer * accel - passing * pulled,
                angular: less * (accel * now.second - passing * now.third)
                    + (passing + passing) * pulled * now.second,
            },
        }
    }

    /// The curve of a robot that drives towards its goal already, with `left` > 0 to drive: it goes on as the robot moves. `None` where
    /// it is not there by `limits`, or too steep.
    ///
    /// Nothing else turns: all that `limits` has is the curve's, v² |z‴| until it brakes, and a |z″| and v |z″| where it is bent most.
    /// A parabola is between the coefficients of its Bernstein form, on the stretch that is asked about: z‴ on that of full speed, and
    /// z″, a cubic, likewise on all of it.
    pub(crate) fn of_robot(limits: &PlanLimits<T>, left: T, robot: &Aside<T>) -> Option<Self> {
        let f = T::from_f64;
        let speed = robot.speed;
        let forward = signed(T::ONE, speed);
        let (square, cube) = (left * left, left * left * left);
        let passing = speed * speed.abs();
        let bent = robot.turn_rate / speed;
        let start = [
            robot.offset,
            forward * left * robot.slope,
            T::HALF * square * bent,
        ];
        let third = cube * (robot.turn_accel - robot.accel * bent) / (f(6.0) * passing);
        let curve = Self::new(left, start, third + straight_third(start));
        let [_, _, begin, _, fourth, _] = curve.powers;
        let [_, _, end, last] = curve.by_share(T::ONE);
        // Half the second derivative's own derivative is three times the sixth of the third.
        let (after, before) = (begin + third, end - last);
        let curvature = f(2.0) * largest([begin, after, before, end]) / square;
        let braking = speed * speed / (f(2.0) * limits.drive.down * left);
        let full = larger(T::ONE - braking, T::ZERO);
        let [_, _, _, at_full] = curve.by_share(full);
        let between = third + full * f(2.0) * fourth;
        let turn_accel = f(6.0) * passing.abs() * largest([third, between, at_full]) / cube;
        let turn_rate = speed.abs() * curvature;
        // A robot that does not drive has no curve that is a number.
        let fits = curve.residue() == T::ZERO
            && robot.slope.abs() <= f(STEEPEST)
            && turn_accel <= limits.turn.up
            && limits.drive.down * curvature <= limits.turn.up
            && turn_rate <= limits.turn.rate
            && rim_speed(speed, turn_rate, limits.half_track) <= limits.rim;
        fits.then_some(curve)
    }

    fn residue(&self) -> T {
        let [a, b, c, _, _, h] = self.powers;
        crate::scalar::residue([a, b, c, h])
    }
}

/// −c₃ of z₀, z₁ and z₂.
fn straight_third<T: Scalar>([a, b, c]: [T; 3]) -> T {
    let f = T::from_f64;
    f(4.0) * a + f(3.0) * b + f(2.0) * c
}

/// The largest size.
fn largest<T: Scalar, const N: usize>(of: [T; N]) -> T {
    of.into_iter()
        .fold(T::ZERO, |most, one| larger(one.abs(), most))
}

#[cfg(test)]
mod tests {
    use super::{Aside, LateralOffset, OffsetLimits};
    use crate::motion::manoeuvre::candidate::PlanLimits;
    use crate::motion::manoeuvre::profile::AxisLimits;
    use crate::types::Twist;

    const LIMITS: OffsetLimits<f64> = OffsetLimits {
        turn_accel: 0.3,
        drive_accel: 1.0,
        heading: 3.0,
        least: 0.0001,
    };

    /// It begins where it is set, in the direction of the planned path, and joins it at its end; derivatives are those of z.
    #[test]
    fn it_leads_back_to_the_path() {
        let offset = LateralOffset::NONE.set(&LIMITS, 0.5, 0.4, 0.001);
        let begin = offset.at(0.5);
        assert!((begin.offset - 0.001).abs() < 1e-12 && begin.first.abs() < 1e-12);
        assert!(begin.second.abs() < 1e-12);
        let end = offset.at(0.0);
        assert!(end.offset.abs() < 1e-12 && end.first.abs() < 1e-12);
        // Central differences err by h²/6 of a derivative that is at most 72 z₀/q₀⁴.
        let h = 1e-4;
        for i in 1..50 {
            let q = 0.01 * f64::from(i);
            let (less, here, more) = (offset.at(q - h), offset.at(q), offset.at(q + h));
            assert!(((more.offset - less.offset) / (2.0 * h) - here.first).abs() < 1e-8);
            assert!(((more.first - less.first) / (2.0 * h) - here.second).abs() < 1e-8);
            assert!(((more.second - less.second) / (2.0 * h) - here.third).abs() < 1e-8);
        }
    }

    /// Set anew on the way, its heading and turn rate go on; its place is what was asked for, or what acceleration there is for.
    #[test]
    fn another_setting_keeps_heading_and_turn_rate() {
        let first = LateralOffset::NONE.set(&LIMITS, 0.5, 0.4, 0.001);
        let before = first.at(0.3);
        let second = first.set(&LIMITS, 0.3, 0.3, 0.0005);
        let after = second.at(0.3);
        assert!((after.offset - 0.0005).abs() < 1e-12);
        assert!((after.first - before.first).abs() < 1e-12);
        assert!((after.second - before.second).abs() < 1e-12);
        let far = LateralOffset::NONE.set(&LIMITS, 0.3, 0.6, 0.1);
        let asked = 0.6 * 0.6 * far.at(0.3).third.abs();
        assert!((asked - LIMITS.turn_accel).abs() < 1e-9, "{asked}");
        // What is already as good as asked for stays, and so does one on which the robot is.
        let offset = before.offset + 0.9 * LIMITS.least;
        assert_eq!(first.set(&LIMITS, 0.3, 0.3, offset), first);
        let offset = before.offset - 1.1 * LIMITS.least;
        assert_ne!(first.set(&LIMITS, 0.3, 0.3, offset), first);
    }

    /// Set anew where it is, however often, a curve with a swell is the same one to its end.
    #[test]
    fn a_curve_that_is_set_where_it_is_stays() {
        let limits = OffsetLimits {
            least: -1.0,
            ..LIMITS
        };
        let robot = Aside {
            offset: 0.004,
            slope: -0.02,
            turn_rate: 0.05,
            turn_accel: 0.4,
            speed: 0.5,
            accel: 0.1,
        };
        let curve = LateralOffset::of_robot(&plan(), 0.4, &robot).expect("possible");
        let mut again = curve;
        for left in [0.35, 0.3, 0.24] {
            again = again.set(&limits, left, 0.5, again.at(left).offset);
        }
        for q in [0.24, 0.15, 0.05, 0.0] {
            let (there, here) = (again.at(q), curve.at(q));
            assert!((there.offset - here.offset).abs() < 1e-14, "{q}");
            assert!((there.second - here.second).abs() < 1e-12, "{q}");
        }
    }

    /// What a reference aside does is what its place does: its heading is that of its way, its twist and acceleration are the rates of
    /// both, forward and backward, speeding up and braking.
    #[test]
    fn what_is_done_aside_is_how_the_place_moves() {
        let limits = OffsetLimits {
            turn_accel: 100.0,
            ..LIMITS
        };
        let curve = LateralOffset::NONE.set(&limits, 0.5, 0.4, 0.04);
        for v in [0.4_f64, -0.4] {
            for accel in [0.5, -0.5] {
                for left in [0.4, 0.3, 0.2] {
                    // Speed, heading and speed along the curve at a time t from now.
                    let at = |t: f64| {
                        let (speed, way) = (v + accel * t, v * t + 0.5 * accel * t * t);
                        let slope = curve.at(left - way * v.signum()).first;
                        let heading = -v.signum() * slope.atan();
                        (heading, speed * (slope * slope).sqrt().hypot(1.0))
                    };
                    let h = 1e-4;
                    let (before, now, after) = (at(-h), at(0.0), at(h));
                    let of = |get: fn((f64, f64)) -> f64| {
                        let [before, now, after] = [before, now, after].map(get);
                        [
                            now,
                            (after - before) / (2.0 * h),
                            (after - now - (now - before)) / (h * h),
                        ]
                    };
                    let [heading, turn_rate, turn_accel] = of(|(heading, _)| heading);
                    let [longer, faster, _] = of(|(_, speed)| speed);
                    let beside = curve.beside(left, &Twist::new(v, 0.0), accel);
                    // Of 0.13, the slope at most, the fifth power is 4e-5 and the fourth 3e-4: what is left out, of rates of some 1.
                    let near = |a: f64, b: f64| (a - b).abs() < 4e-4 * (1.0 + b.abs());
                    assert!((beside.turned + heading).abs() < 4e-5, "{heading}");
                    assert!(near(beside.twist.angular, turn_rate), "{turn_rate}");
                    assert!(near(beside.accel.angular, turn_accel), "{turn_accel}");
                    assert!((v + beside.twist.linear - longer).abs() < 4e-5, "{longer}");
                    assert!(near(accel + beside.accel.linear, faster), "{faster}");
                    // To the left of a reference that turns left it is on the inside, and slower.
                    let turning = curve.beside(left, &Twist::new(v, 0.7), accel);
                    let inside = turning.twist.linear - beside.twist.linear;
                    assert!((inside + 0.7 * beside.offset).abs() < 1e-15);
                    assert_eq!(beside.slope, curve.at(left).first);
                }
            }
        }
    }

    /// Where less than the heading's time constant is left nothing is set, nor for what is not worth it.
    #[test]
    fn it_may_be_too_late_or_too_little() {
        let none = LateralOffset::NONE;
        assert_eq!(none.set(&LIMITS, 0.5, 0.3, -0.0001), none);
        assert_eq!(none.set(&LIMITS, 0.049, 0.3, 0.001), none);
        assert!(none.set(&LIMITS, 0.051, 0.3, 0.001).is_set());
    }

    /// Drives at 1 m/s² and turns at 2 rad/s².
    fn plan() -> PlanLimits<f64> {
        let axis = |rate, accel| AxisLimits {
            rate,
            up: accel,
            down: accel,
            jerk_s: 0.05,
        };
        PlanLimits {
            drive: axis(1.0, 1.0),
            turn: axis(2.0, 2.0),
            rim: 1.2,
            half_track: 0.2,
        }
    }

    /// It begins as the robot moves, forward and backward; an arc that ends at the goal is one.
    #[test]
    fn the_curve_of_a_robot_goes_on_as_it_moves() {
        let (left, curvature) = (0.4, 0.3);
        for speed in [0.5, -0.5] {
            let arc = Aside {
                offset: 0.5 * curvature * left * left,
                // Forward it drives down towards the path, backward it looks up.
                slope: -curvature * left * f64::signum(speed),
                turn_rate: curvature * speed,
                turn_accel: 0.0,
                speed,
                accel: 0.0,
            };
            let curve = LateralOffset::of_robot(&plan(), left, &arc).expect("possible");
            for share in [1.0, 0.7, 0.2, 0.0] {
                let q = share * left;
                let now = curve.at(q);
                assert!((now.offset - 0.5 * curvature * q * q).abs() < 1e-12);
                assert!((now.first - curvature * q).abs() < 1e-12);
                assert!((now.second - curvature).abs() < 1e-12 && now.third.abs() < 1e-11);
            }
            let weaving = Aside {
                offset: arc.offset + 0.002,
                turn_accel: 0.3,
                accel: 0.2,
                ..arc
            };
            let curve = LateralOffset::of_robot(&plan(), left, &weaving).expect("possible");
            let (begin, end) = (curve.at(left), curve.at(0.0));
            assert!((begin.offset - weaving.offset).abs() < 1e-12);
            assert!((begin.first - curvature * left).abs() < 1e-12);
            assert!((speed * begin.second - weaving.turn_rate).abs() < 1e-12);
            let turning = weaving.accel * begin.second - speed * speed.abs() * begin.third;
            assert!((turning - weaving.turn_accel).abs() < 1e-12);
            assert!(end.offset.abs() < 1e-12 && end.first.abs() < 1e-12);
            // Set anew where the robot is on it, it is the same curve.
            let here = curve.at(0.3);
            let same = curve.set(&LIMITS, 0.3, speed, here.offset + 1.001 * LIMITS.least);
            let (there, here) = (same.at(0.2), curve.at(0.2));
            assert!((there.offset - here.offset).abs() < 1.1 * LIMITS.least);
            assert!((there.third - here.third).abs() < 0.3);
        }
    }

    /// Too steep, too sharply bent for how fast it has to be driven, too fast for a rim, or too far aside: there is none. None that is
    /// taken turns quicker than it may while the robot drives at full speed.
    #[test]
    fn a_curve_of_a_robot_keeps_the_limits() {
        let plan = plan();
        let of = |left, speed, offset, slope, turn_rate| {
            let robot = Aside {
                offset,
                slope,
                turn_rate,
                turn_accel: 0.0,
                speed,
                accel: 0.0,
            };
            LateralOffset::of_robot(&plan, left, &robot)
        };
        assert!(of(0.4, 0.5, 0.0, 0.25, 0.0).is_none());
        assert!(of(0.4, 0.2, 0.0, 0.0, 0.5).is_none());
        assert!(of(0.4, 1.0, 0.0, 0.0, 1.5).is_none());
        assert!(of(0.4, 0.5, 0.05, 0.0, 0.0).is_none());
        assert!(of(0.4, 0.0, 0.0, 0.0, 0.1).is_none());
        assert!(of(0.4, 0.0, 0.0, 0.0, 0.0).is_none());
        let mut taken = 0;
        for i in 0..200 {
            let i = f64::from(i);
            let speed = 0.1 + 0.004 * i;
            let (offset, slope) = (0.02 * (2.4 * i).sin(), 0.1 * (1.7 * i).cos());
            let Some(curve) = of(0.4, speed, offset, slope, -slope * speed / 0.4) else {
                continue;
            };
            taken += 1;
            let brakes = 0.5 * speed * speed / plan.drive.down;
            for step in 0..=100 {
                let q = 0.004 * f64::from(step);
                let now = curve.at(q);
                let turning = speed * speed * now.third.abs();
                assert!(
                    q < brakes || turning < plan.turn.up + 1e-9,
                    "{i}: {turning}"
                );
                assert!(
                    plan.drive.down * now.second.abs() < plan.turn.up + 1e-9,
                    "{i}"
                );
            }
        }
        assert!(taken > 50, "{taken}");
    }

    /// The curve is taken where everything that it asks for is there, and not where anything is not, whatever the speed and its rate. A
    /// coefficient of Bernstein's is at most 3 times the most of a parabola, and 5 times that of a cubic (Chebyshev's have those).
    #[test]
    fn a_curve_of_a_robot_is_taken_where_it_fits() {
        let (mut taken, mut refused) = (0, 0);
        for i in 0..4000 {
            let part = |of: f64| 2.0 * (of * f64::from(i)).rem_euclid(1.0) - 1.0;
            let left = 0.3 + 0.2 * part(0.618_034);
            let speed = 0.6 * part(0.754_878) + 0.1 * part(0.754_878).signum();
            let robot = Aside {
                offset: 0.004 * part(0.569_840),
                slope: 0.03 * part(0.819_173),
                turn_rate: 0.1 * part(0.671_044),
                turn_accel: 0.5 * part(0.549_700),
                speed,
                accel: 0.5 * part(0.856_675),
            };
            let mut wide = plan();
            wide.turn.up = 1e6;
            wide.turn.rate = 1e6;
            wide.rim = 1e6;
            let curve = LateralOffset::of_robot(&wide, left, &robot).expect("wide");
            let brakes = 0.5 * speed * speed / wide.drive.down;
            let (mut swing, mut curvature) = (0.0_f64, 0.0_f64);
            for step in 0..=200 {
                let q = left * f64::from(step) / 200.0;
                let now = curve.at(q);
                curvature = curvature.max(now.second.abs());
                if q >= brakes.min(left) {
                    swing = swing.max(speed * speed * now.third.abs());
                }
            }
            let braking = wide.drive.down * curvature;
            let (least, most) = (swing.max(braking), (3.0 * swing).max(5.0 * braking));
            for (limit, fits) in [(0.999 * least, false), (1.001 * most, true)] {
                let mut plan = wide;
                plan.turn.up = limit;
                let curve = LateralOffset::of_robot(&plan, left, &robot);
                assert_eq!(
                    curve.is_some(),
                    fits,
                    "{i}: {robot:?} {left} {swing} {curvature}"
                );
            }
            let mut plan = wide;
            plan.turn.rate = 0.999 * speed.abs() * curvature;
            refused += u32::from(LateralOffset::of_robot(&plan, left, &robot).is_none());
            plan.turn.rate = 5.0 * speed.abs() * curvature;
            taken += u32::from(LateralOffset::of_robot(&plan, left, &robot).is_some());
        }
        assert_eq!((taken, refused), (4000, 4000));
    }
}
