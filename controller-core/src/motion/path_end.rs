//! The end of a path that comes to rest: what a robot is aside of it there, worked off by the goal.

use super::manoeuvre::{LateralOffset, OffsetLimits, SETTING_S};
use super::params::ValidMotionParams;
use crate::maths::Maths;
use crate::range::larger;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Accel, Pose, Twist};

/// The largest share of the limit on angular acceleration that references should use: [`PathEnd`] leads within the rest, and feedback has
/// it until then.
pub const REFERENCE_TURN_SHARE: f64 = 0.6;

/// Leads a robot that is beside its path to the path's end, where references say how far that is
/// ([`Reference::left_m`]). A base does so by itself; for others who follow a path that comes to rest.
///
/// Lateral feedback asks for the less turning the slower the path is, and noise and delays keep it soft: what tyres have slipped aside
/// in a curve is at the goal for the most part still there, where another manoeuvre has to mend it. Who has the whole path can do better:
/// the reference goes to where the robot is, and from there along a curve that joins the path at its end, as in a manoeuvre. What
/// the robot has to turn for it is fed forward.
///
/// It begins as late as half of the angular acceleration that references leave lets it, and never for less than half of
/// [`Arrival::distance_m`](super::Arrival), or more where the path turns rather than drives, by as much as rims turn faster than it
/// drives: there what the curve lets a robot lack of the heading is worse than what it is aside. Until then the robot follows the path
/// itself.
///
/// ```
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, MotionParams, PathEnd};
/// use controller_core::reference::Reference;
/// use controller_core::robot::Robot;
/// use controller_core::types::{Accel, Pose, Twist};
///
/// let motion = MotionParams::<f32>::new(Robot::paper(), Limits::PAPER.cast()).validate()?;
/// let mut end = PathEnd::NEW;
/// // Along x, braking: 0.2 m to go at 0.4 m/s. The robot is 5 mm to the left.
/// let mut reference = Reference::new(Pose::default(), Twist::new(0.4, 0.0), Accel::new(-0.4, 0.0)).with_left(0.2);
/// let beside = Pose::new(0.0, 0.005, 0.0);
/// end.lead::<Single>(&motion, &mut reference, &beside, 0.01);
/// assert!(reference.pose().y > 0.0);
/// # Ok::<(), controller_core::error::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathEnd<T = f32> {
    offset: LateralOffset<T>,
    /// Until the offset may be set anew \[s\].
    wait_s: T,
}

impl<T: Scalar> PathEnd<T> {
    /// For a path that begins.
    pub const NEW: Self = Self {
        offset: LateralOffset::NONE,
        wait_s: T::ZERO,
    };

    /// Makes of `reference` what a robot `at` a measured pose is to follow in a tick of `dt` \[s\].
    ///
    /// With the offset e of the robot, a curve asks for 24 |e| v²/q³ at its begin, q being what is left.
    /// Where anything is not finite, nothing changes.
    pub fn lead<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        reference: &mut Reference<T>,
        at: &Pose<T>,
        dt: T,
    ) {
        let (pose, heading) = (reference.pose(), reference.heading());
        // To the left of the reference.
        let robot = (at.y - pose.y) * heading.cos - (at.x - pose.x) * heading.sin;
        if self.offset.is_set() || begins(motion, reference, robot) {
            self.lead_aside::<M>(motion, reference, robot, dt);
        }
    }

    /// Apart: on its path a robot is at most ticks.
    #[inline(never)]
    fn lead_aside<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        reference: &mut Reference<T>,
        robot: T,
        dt: T,
    ) {
        let (v, left) = (reference.twist().linear, reference.left_m());
        let sound = reference.is_finite() && (robot + dt).is_finite();
        if !sound || v == T::ZERO || left <= T::ZERO {
            return;
        }
        let is_set = self.offset.is_set();
        self.wait_s = if is_set { self.wait_s - dt } else { T::ZERO };
        if self.wait_s <= T::ZERO {
            self.wait_s = T::from_f64(SETTING_S);
            self.offset = self.offset.set(&limits(motion), left, v, robot);
        }
        if self.offset.is_set() {
            *reference = self.moved_aside::<M>(reference);
        }
    }

    fn moved_aside<M: Maths<T>>(&self, reference: &Reference<T>) -> Reference<T> {
        let (pose, heading) = (reference.pose(), reference.heading());
        let (twist, accel) = (reference.twist(), reference.accel());
        let left = reference.left_m();
        let beside = self.offset.beside(left, twist, accel.linear);
        // Of −z w, which a path that curves to its end has, and a manoeuvre hardly.
        let bent =
            twist.linear.abs() * beside.slope * twist.angular - beside.offset * accel.angular;
        Reference::new_with::<M>(
            Pose {
                x: pose.x - heading.sin * beside.offset,
                y: pose.y + heading.cos * beside.offset,
                theta: pose.theta - beside.turned,
            },
            Twist {
                linear: twist.linear + beside.twist.linear,
                angular: twist.angular + beside.twist.angular,
            },
            Accel {
                linear: accel.linear + beside.accel.linear + bent,
                angular: accel.angular + beside.accel.angular,
            },
        )
        .with_left(left)
    }
}

/// What a curve may ask for: what references leave.
fn limits<T: Scalar>(motion: &ValidMotionParams<T>) -> OffsetLimits<T> {
    OffsetLimits {
        turn_accel: T::from_f64(1.0 - REFERENCE_TURN_SHARE) * motion.params().limits.turn_accel,
        // The path is braked on; it will not be quicker than now.
        drive_accel: T::ZERO,
        ..motion.offset_limits()
    }
}

/// A `robot` so far to the left of the reference is to be led from now on.
fn begins<T: Scalar>(motion: &ValidMotionParams<T>, reference: &Reference<T>, robot: T) -> bool {
    let (twist, params) = (reference.twist(), motion.params());
    let (speed, aside) = (twist.linear.abs(), robot.abs());
    let half_track = T::HALF * params.robot.wheels.track_m;
    let rim = half_track * twist.angular.abs();
    let tolerated = T::HALF * params.arrival.distance_m;
    aside * speed > tolerated * larger(speed, rim) && {
        let (left, limits) = (reference.left_m(), limits(motion));
        let asked = T::from_f64(24.0) * aside * speed * speed;
        left > limits.least && asked > T::HALF * limits.turn_accel * (left * left * left)
    }
}

#[cfg(test)]
mod tests {
    use super::{PathEnd, REFERENCE_TURN_SHARE};
    use crate::maths::Libm;
    use crate::motion::{Limits, MotionParams, ValidMotionParams};
    use crate::reference::{ConstantTwist, Reference};
    use crate::robot::Robot;
    use crate::types::{Accel, Pose, Twist};

    /// Of the paths \[m/s²\].
    const BRAKE: f64 = 0.4;
    const DT: f64 = 0.01;

    /// On an arc of so much curvature \[1/m\], forward or backward (`way` of 1 or −1), braking evenly, with `left` to go.
    fn braking(curvature: f64, way: f64, left: f64) -> Reference<f64> {
        let path = ConstantTwist {
            start: Pose::new(3.0, -1.0, 0.7),
            twist: Twist::new(1.0, curvature),
        };
        let pose = *path.at::<Libm>(-way * left).pose();
        let (v, a) = (way * (2.0 * BRAKE * left).sqrt(), -way * BRAKE);
        let twist = Twist::new(v, curvature * v);
        Reference::new_with::<Libm>(pose, twist, Accel::new(a, curvature * a)).with_left(left)
    }

    /// What is left after so long \[s\].
    fn later(left: f64, t: f64) -> f64 {
        let speed = (2.0 * BRAKE * left).sqrt();
        left - t * (speed - 0.5 * BRAKE * t)
    }

    fn motion() -> ValidMotionParams<f64> {
        let params = MotionParams::new(Robot::paper(), Limits::PAPER);
        params.validate().expect("valid")
    }

    /// What is followed of a reference by a robot so far to the left of it, in a tick of `dt`.
    fn led(
        end: &mut PathEnd<f64>,
        reference: Reference<f64>,
        aside: f64,
        dt: f64,
    ) -> Reference<f64> {
        let (pose, heading) = (reference.pose(), reference.heading());
        let at = Pose {
            x: pose.x - heading.sin * aside,
            y: pose.y + heading.cos * aside,
            // Nobody asks where it heads.
            theta: 9.0,
        };
        let mut to = reference;
        end.lead::<Libm>(&motion(), &mut to, &at, dt);
        to
    }

    /// To the left of a reference \[m\].
    fn beside(reference: &Reference<f64>, led: &Reference<f64>) -> f64 {
        let (from, to, heading) = (reference.pose(), led.pose(), reference.heading());
        (to.y - from.y) * heading.cos - (to.x - from.x) * heading.sin
    }

    /// As the document says: half of what references leave, half of the tolerance, more where the path turns; and not at the very end.
    #[test]
    fn it_begins_as_late_as_it_can() {
        let params = *motion().params();
        let (tolerance, left_over) = (
            0.5 * params.arrival.distance_m,
            (1.0 - REFERENCE_TURN_SHARE) * params.limits.turn_accel,
        );
        // What is left, the curvature; the least that a robot is aside of then.
        let far = |left: f64| 0.5 * left_over * left.powi(3) / (24.0 * 2.0 * BRAKE * left);
        let cases = [
            (0.3, 0.0, far(0.3)),
            (0.2, -0.5, far(0.2)),
            (0.04, 0.0, tolerance),
            // Rims turn at 0.25 m times the curvature of what it drives.
            (0.04, 12.0, 3.0 * tolerance),
        ];
        for (left, curvature, least) in cases {
            for (way, side) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0)] {
                let reference = braking(curvature, way, left);
                let mut end = PathEnd::NEW;
                let aside = |share: f64| side * share * least;
                assert_eq!(led(&mut end, reference, aside(0.99), DT), reference);
                assert_eq!(end, PathEnd::NEW);
                let on = led(&mut end, reference, aside(1.01), DT);
                let moved = side * beside(&reference, &on);
                assert!(moved > 0.0, "{left} {curvature} {way}: {moved}");
            }
        }
        let tenth = 0.1 * params.arrival.distance_m;
        for (left, begins) in [(0.99 * tenth, false), (1.01 * tenth, true)] {
            let mut end = PathEnd::NEW;
            // Slow enough for the curve not to be too late.
            let pose = *braking(0.0, 1.0, left).pose();
            let slow = Twist::new(0.1 * left, 0.0);
            let reference =
                Reference::new_with::<Libm>(pose, slow, Accel::default()).with_left(left);
            let on = led(&mut end, reference, 1.0, DT);
            assert_eq!(on != reference, begins, "{left}");
        }
    }

    /// From where the robot is, which the limits allow, to the end of the path; its heading is that of its way, its twist the rate of its pose, and its acceleration
    /// that of its twist. For a robot that stays as far aside the curve is not set anew for a tenth of a second.
    #[test]
    fn what_is_led_is_a_path() {
        let h = 1.0e-4;
        for (curvature, way, aside) in [
            (0.0, 1.0, 8e-4),
            (0.0, -1.0, 8e-4),
            (1.0, 1.0, -8e-4),
            (-1.0, -1.0, 6e-4),
        ] {
            let start = 0.12;
            let mut end = PathEnd::NEW;
            let mut way_on = [0, 1, 2].map(|tick| {
                let left = later(start, h * f64::from(tick));
                led(&mut end, braking(curvature, way, left), aside, h)
            });
            let begin = beside(&braking(curvature, way, start), &way_on[0]);
            assert!((begin / aside - 1.0).abs() < 1e-9, "{begin}");
            for tick in 3..900 {
                let [before, now, after] = way_on;
                let over = |from: f64, to: f64| (to - from) / (2.0 * h);
                let (heading, twist, accel) = (now.heading(), now.twist(), now.accel());
                let x = over(before.pose().x, after.pose().x);
                let y = over(before.pose().y, after.pose().y);
                let along = x * heading.cos + y * heading.sin;
                let across = y * heading.cos - x * heading.sin;
                // The curve's heading and length are known to a thousandth, and v z κ is left out of the heading.
                let slack = 2e-3 * (twist.linear.abs() + 0.01);
                assert!(
                    (along - twist.linear).abs() < slack,
                    "{tick}: {along} {twist:?}"
                );
                assert!(across.abs() < slack, "{tick}: {across}");
                let turned = over(before.pose().theta, after.pose().theta);
                assert!(
                    (turned - twist.angular).abs() < 0.02 * (twist.angular.abs() + 0.01),
                    "{tick}: {turned} {twist:?}"
                );
                let gained = over(before.twist().angular, after.twist().angular);
                assert!(
                    (gained - accel.angular).abs() < 0.03 * (accel.angular.abs() + 0.1),
                    "{tick}: {gained} {accel:?}"
                );
                let gained = over(before.twist().linear, after.twist().linear);
                assert!(
                    (gained - accel.linear).abs() < 0.03 * BRAKE,
                    "{tick}: {gained} {accel:?}"
                );
                let left = later(start, h * f64::from(tick));
                let next = led(&mut end, braking(curvature, way, left), aside, h);
                assert_eq!(next.left_m(), left);
                way_on = [now, after, next];
            }
        }
    }

    /// Sideways nothing jumps, and the curve that was begun ends on the path.
    #[test]
    fn it_ends_at_the_end() {
        for aside in [8e-4, -6e-4] {
            let (mut end, start) = (PathEnd::NEW, 0.12);
            let duration = (2.0 * start / BRAKE).sqrt();
            let ticks = (duration / DT) as u32;
            let mut last = aside;
            for tick in 0..=ticks {
                let reference = braking(0.5, 1.0, later(start, DT * f64::from(tick)));
                // The robot goes where it is led.
                let on = led(&mut end, reference, last, DT);
                let now = beside(&reference, &on);
                assert!(
                    (now - last).abs() < 0.1 * aside.abs(),
                    "{tick}: {now} {last}"
                );
                last = now;
            }
            assert!(last.abs() < 1e-5, "{last}");
        }
    }

    /// What a robot is aside of the curve meanwhile is taken up after a tenth of a second, and not before.
    #[test]
    fn it_is_set_anew_every_tenth_of_a_second() {
        let mut ends = [PathEnd::NEW; 2];
        for tick in 0..12 {
            let reference = braking(0.0, 1.0, later(0.12, DT * f64::from(tick)));
            let [quiet, pushed] = &mut ends;
            let here = led(quiet, reference, 6e-4, DT);
            let there = led(pushed, reference, if tick < 5 { 6e-4 } else { 7e-4 }, DT);
            // A tick early or late by rounding.
            if tick != 10 {
                assert_eq!(here == there, tick < 10, "{tick}");
            }
        }
    }

    /// A robot that is led follows the path itself in a tick that says nothing of use.
    #[test]
    fn what_is_of_no_use_changes_nothing() {
        let mut begun = PathEnd::NEW;
        led(&mut begun, braking(0.0, 1.0, 0.12), 2e-3, DT);
        let sound = braking(0.0, 1.0, 0.1);
        let with =
            |twist: Twist<f64>| Reference::new_with::<Libm>(*sound.pose(), twist, *sound.accel());
        let standing = with(Twist::new(0.0, 0.1)).with_left(0.1);
        let over = [0.0, -0.1].map(|left| sound.with_left(left));
        let unsound = with(Twist::new(0.2, f64::INFINITY)).with_left(0.1);
        let nowhere = sound.with_left(0.1);
        for (reference, aside, dt) in [
            (standing, 2e-3, DT),
            (over[0], 2e-3, DT),
            (over[1], 2e-3, DT),
            (unsound, 2e-3, DT),
            (nowhere, f64::INFINITY, DT),
            (nowhere, f64::INFINITY, f64::NEG_INFINITY),
            (nowhere, 0.0, f64::INFINITY),
        ] {
            let mut end = begun;
            assert_eq!(led(&mut end, reference, aside, dt), reference);
            assert_eq!(end, begun, "{reference:?} {aside} {dt}");
        }
        let mut end = begun;
        assert_ne!(led(&mut end, sound, 2e-3, DT), sound);
    }
}
