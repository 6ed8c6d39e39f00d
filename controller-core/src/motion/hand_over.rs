//! When to leave the path and park.

use super::params::ValidMotionParams;
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::Twist;

/// What is left of a trajectory that ends at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Remaining<T = f32> {
    /// Along the path, forward and backward alike \[m\].
    pub path_m: T,
    /// Turning, to either side alike \[rad\].
    pub turn_rad: T,
}

impl<T: Scalar> Remaining<T> {
    /// Adds the longitudinal error: a robot behind its `reference` has that distance to drive as well.
    #[must_use]
    pub fn with_error(self, reference: &Reference<T>, error: &PoseError<T>) -> Self {
        let behind = if reference.twist().linear < T::ZERO {
            -error.x
        } else {
            error.x
        };
        Self {
            path_m: self.path_m + behind,
            ..self
        }
    }

    /// Both path and turn are short enough for parking. A route that ends by turning in place has no path
    /// left during the turn, and is followed until the turn is nearly done.
    ///
    /// `distance` gives the distance that parking needs from a speed, [`ValidMotionParams::hand_over_distance`]. A turn
    /// is compared by the travel of a wheel, which is `lever_m` (half the track) from the centre \[m\].
    pub fn is_short<M: Maths<T>>(
        &self,
        command: &Twist<T>,
        lever_m: T,
        distance: impl Fn(T) -> T,
    ) -> bool {
        let Twist { linear, angular } = *command;
        let rim = lever_m * angular;
        let near = self.path_m <= distance(linear);
        let turned = lever_m * self.turn_rad <= distance(M::sqrt(linear * linear + rim * rim));
        near && turned
    }
}

impl<T: Scalar> ValidMotionParams<T> {
    /// Parking takes over from a trajectory with this path and turn `remaining` and this `command` in force.
    pub fn parking_is_due<M: Maths<T>>(
        &self,
        remaining: &Remaining<T>,
        command: &Twist<T>,
    ) -> bool {
        let lever = T::HALF * self.params().robot.wheels.track_m;
        remaining.is_short::<M>(command, lever, |speed| self.hand_over_distance(speed))
    }

    /// Distance to the goal \[m\], along the path, at which to change from following to parking: far
    /// enough for the robot not to overshoot from `speed` \[m/s\], and a time constant of its heading before that, v/k₃, in which
    /// parking takes back what following left to the side.
    ///
    /// The approach decays as exp(−k₄ t), and the transition offset from the speed at hand-over carries the
    /// robot on by its share: v (1/(2 k₄) + 1/A). Where k₄ v is more than the planned deceleration
    /// p, braking at p takes over: v²/(2p) + p/(8 k₄²) + v/A.
    pub fn hand_over_distance(&self, speed: T) -> T {
        let f = T::from_f64;
        let gains = self.gains();
        let v = speed.abs();
        let (k4, p) = (gains.approach, gains.approach_brake);
        let linear = v * (T::HALF / k4 + T::ONE / gains.decay);
        let braking = v * v / (p + p) + p / (f(8.0) * k4 * k4) + v / gains.decay;
        let stopping = if k4 * v > p && braking > linear {
            braking
        } else {
            linear
        };
        let needed = stopping + v / gains.heading;
        // Even from rest a goal this near is the parking law's business.
        let least = f(0.05);
        if needed > least { needed } else { least }
    }
}
