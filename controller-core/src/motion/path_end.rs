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
/// in a bend is at the goal for the most part still there, where another manoeuvre has to mend it. Who has the whole path can do better:
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
        // Of −z w, which a path that bends to its end has, and a manoeuvre hardly.
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
