//! What a robot is aside of its manoeuvre, worked off by the goal.
//!
//! A manoeuvre is driven as planned, and what the robot lacks of it is the follower's: in the second that the last drive takes, its lateral
//! feedback, which noise and delays keep soft, works off a half. So the reference goes to where the robot is, and from there along a
//! curve that joins the planned one at the goal: what the robot has to turn for it is fed forward.

use crate::range::{clamp, larger};
use crate::scalar::Scalar;

/// Time between two settings of the offset \[s\]: a fix or two, and no less than the follower's neurons need to answer the last one
/// (1/A, 0.1 to 0.2 s). In every tick, it would answer its own corrections, and weave.
pub(crate) const SETTING_S: f64 = 0.1;

/// The driven reference lies z to the left of the planned one:
///
/// ```text
/// z(w) = z₀ + z₁ w + z₂ w² + c₃ w³ + c₄ w⁴        w = 1 − q/q₀        z(1) = z′(1) = 0
/// c₃ = −4 z₀ − 3 z₁ − 2 z₂                        c₄ = 3 z₀ + 2 z₁ + z₂
/// ```
///
/// | symbol | what | unit |
/// | --- | --- | --- |
/// | q, q₀ | distance left of the last drive, now and where z was set | m |
/// | z₀, z₁, z₂ | offset there, its first derivative and half its second by w | m |
///
/// z₁ and z₂ are those of the curve until then: heading and turn rate of the reference do not jump, its place does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LateralOffset<T> {
    /// q₀; 0 where there is no offset.
    from: T,
    start: [T; 3],
}

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
    /// There is one.
    pub(crate) fn is_set(&self) -> bool {
        self.from > T::ZERO
    }

    /// z, z′, z″/2 and z‴/6 by w.
    fn by_share(&self, w: T) -> [T; 4] {
        let (two, three, four, six) = (
            T::from_f64(2.0),
            T::from_f64(3.0),
            T::from_f64(4.0),
            T::from_f64(6.0),
        );
        let [a, b, c] = self.start;
        let (d, e) = (-(four * a + three * b + two * c), three * a + two * b + c);
        [
            a + w * (b + w * (c + w * (d + w * e))),
            b + w * (two * c + w * (three * d + w * four * e)),
            c + w * (three * d + w * six * e),
            d + w * four * e,
        ]
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
    /// the curve asks for at its begin, 6 |c₃| v²/q³, has to be there: z₀ is as much of `offset` as it is. v is what is driven, or
    /// what will be where the drive has just begun, √(a q).
    pub(crate) fn set(&self, limits: &OffsetLimits<T>, left: T, speed: T, offset: T) -> Self {
        let f = T::from_f64;
        let change = offset - self.at(left).offset;
        if change.abs() <= limits.least || f(2.0) * left * limits.heading <= speed.abs() {
            return *self;
        }
        let (first, second) = if self.is_set() {
            let share = left / self.from;
            let [_, first, second, _] = self.by_share(T::ONE - share);
            (share * first, share * share * second)
        } else {
            (T::ZERO, T::ZERO)
        };
        let fast = larger(speed * speed, limits.drive_accel * left);
        let most = limits.turn_accel * left * left * left / (f(6.0) * fast);
        let rest = f(3.0) * first + f(2.0) * second;
        let third = clamp(-(f(4.0) * offset + rest), most);
        Self {
            from: left,
            start: [f(-0.25) * (third + rest), first, second],
        }
    }

    pub(crate) fn residue(&self) -> T {
        let [a, b, c] = self.start;
        crate::scalar::residue([a, b, c])
    }
}

#[cfg(test)]
mod tests {
    use super::{LateralOffset, OffsetLimits};

    const LIMITS: OffsetLimits<f64> = OffsetLimits {
        turn_accel: 0.3,
        drive_accel: 1.0,
        heading: 3.0,
        least: 0.0001,
    };

    /// It begins where it is set, in the direction of the planned path, and joins it at its end; derivatives are those of z.
    #[test]
    fn it_leads_back_to_the_path() {
        let offset = LateralOffset::default().set(&LIMITS, 0.5, 0.4, 0.001);
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
        let first = LateralOffset::default().set(&LIMITS, 0.5, 0.4, 0.001);
        let before = first.at(0.3);
        let second = first.set(&LIMITS, 0.3, 0.3, 0.0005);
        let after = second.at(0.3);
        assert!((after.offset - 0.0005).abs() < 1e-12);
        assert!((after.first - before.first).abs() < 1e-12);
        assert!((after.second - before.second).abs() < 1e-12);
        let far = LateralOffset::default().set(&LIMITS, 0.3, 0.6, 0.1);
        let asked = 0.6 * 0.6 * far.at(0.3).third.abs();
        assert!((asked - LIMITS.turn_accel).abs() < 1e-9, "{asked}");
    }

    /// Where less than the heading's time constant is left nothing is set, nor for what is not worth it.
    #[test]
    fn it_may_be_too_late_or_too_little() {
        let none = LateralOffset::default();
        assert_eq!(none.set(&LIMITS, 0.5, 0.3, -0.0001), none);
        assert_eq!(none.set(&LIMITS, 0.049, 0.3, 0.001), none);
        assert!(none.set(&LIMITS, 0.051, 0.3, 0.001).is_set());
    }
}
