//! The end of a path that comes to rest: what a robot is aside of it there, worked off by the goal.

use super::manoeuvre::{LateralOffset, OffsetLimits, SETTING_S};
use super::params::ValidMotionParams;
use crate::maths::Maths;
use crate::pose_error::tracking_error;
use crate::range::larger;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Accel, Pose, Twist};

/// The largest share of the limit on angular acceleration that references should use: [`PathEnd`] leads within the rest, and feedback has
/// it until then.
pub const REFERENCE_TURN_SHARE: f64 = 0.6;

/// Leads a robot that is beside its path to the path's end: for whoever gives the references of a path that comes to rest.
///
/// Lateral feedback asks for the less turning the slower the path is, and noise and delays keep it soft: what tyres have slipped aside
/// in a bend is at the goal for the most part still there, where another manoeuvre has to mend it. Who has the whole path can do better:
/// the reference goes to where the robot is, and from there along a curve that joins the path at its end, as in a manoeuvre. What
/// the robot has to turn for it is fed forward.
///
/// It begins as late as half of the angular acceleration that references leave lets it, and never for less than half of
/// [`Arrival::distance_m`](super::Arrival), or more where the path turns rather than drives, by as much as rims turn faster than it
/// drives: there what the curve lets a robot lack of the heading is worse than what it is aside. Until then the robot follows the path
/// itself; on its path it gets its reference as it is, bit for bit.
///
/// ```
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, MotionParams, PathEnd};
/// use controller_core::reference::Reference;
/// use controller_core::robot::Robot;
/// use controller_core::types::{Accel, Pose, Twist};
///
/// let motion = MotionParams::<f32>::new(Robot::paper(), Limits::PAPER.cast()).validate()?;
/// let mut end = PathEnd::new();
/// // Along x, braking: 0.2 m to go at 0.4 m/s. The robot is 5 mm to the left.
/// let reference = Reference::new(Pose::default(), Twist::new(0.4, 0.0), Accel::new(-0.4, 0.0));
/// let beside = Pose::new(0.0, 0.005, 0.0);
/// let led = end.lead::<Single>(&motion, &reference, &beside, 0.2, 0.01);
/// assert!(led.pose().y > 0.0);
/// # Ok::<(), controller_core::error::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathEnd<T = f32> {
    offset: LateralOffset<T>,
    /// Time since the offset was set \[s\].
    set_s: T,
}

impl<T: Scalar> PathEnd<T> {
    /// For a path that begins.
    pub fn new() -> Self {
        Self {
            offset: LateralOffset::default(),
            set_s: T::from_f64(SETTING_S),
        }
    }

    /// What a robot `at` a measured pose is to follow instead of `reference` in a tick of `dt` \[s\]. The path has `left` to go until
    /// it rests \[m\], all of it forward or all of it backward: before its last drive this is not called.
    ///
    /// With the offset e of the robot, a curve asks for 24 |e| v²/q³ at its begin, q being what is left.
    /// Numbers that are not finite are given back as they came, and change nothing.
    pub fn lead<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        reference: &Reference<T>,
        at: &Pose<T>,
        left: T,
        dt: T,
    ) -> Reference<T> {
        let v = reference.twist().linear;
        let share = T::from_f64(1.0 - REFERENCE_TURN_SHARE);
        let limits = OffsetLimits {
            turn_accel: share * motion.params().limits.turn_accel,
            // The path is braked on; it will not be quicker than now.
            drive_accel: T::ZERO,
            ..motion.offset_limits()
        };
        let (error, (sine, cosine)) = tracking_error::<T, M>(reference, at);
        // To the left of the reference.
        let robot = sine * error.x - cosine * error.y;
        let sound = reference.is_finite() && (robot + left + dt).is_finite();
        if !sound || v == T::ZERO || left <= T::ZERO {
            return *reference;
        }
        self.set_s += dt;
        if self.set_s >= T::from_f64(SETTING_S) && left > limits.least {
            let half_track = T::HALF * motion.params().robot.wheels.track_m;
            let rim = half_track * reference.twist().angular.abs();
            let tolerated = T::HALF * motion.params().arrival.distance_m * larger(v.abs(), rim);
            let asked = T::from_f64(24.0) * robot.abs() * v * v / (left * left * left);
            let begins = robot.abs() * v.abs() > tolerated && asked > T::HALF * limits.turn_accel;
            if self.offset.is_set() || begins {
                self.set_s = T::ZERO;
                self.offset = self.offset.set(&limits, left, v, robot);
            }
        }
        if !self.offset.is_set() {
            return *reference;
        }
        self.moved_aside::<M>(reference, left)
    }

    fn moved_aside<M: Maths<T>>(&self, reference: &Reference<T>, left: T) -> Reference<T> {
        let (pose, heading) = (reference.pose(), reference.heading());
        let (twist, accel) = (reference.twist(), reference.accel());
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
    }
}

impl<T: Scalar> Default for PathEnd<T> {
    fn default() -> Self {
        Self::new()
    }
}
