//! When to leave the path and park.

use super::params::Motion;
use crate::scalar::Scalar;

impl<T: Scalar> Motion<T> {
    /// Distance to the goal \[m\], along the path, at which to change from following to parking: far
    /// enough for the robot not to overshoot from `speed` \[m/s\].
    ///
    /// The approach decays as exp(−k₄ t), and the bridge from the speed at hand-over carries the
    /// robot on by its share: v (1/(2 k₄) + 1/A). Where k₄ v is more than the planned deceleration
    /// p, braking at p takes over: v²/(2p) + p/(8 k₄²) + v/A.
    pub fn hand_over_distance(&self, speed: T) -> T {
        let f = T::from_f64;
        let gains = self.gains();
        let v = speed.abs();
        let (k4, p) = (gains.approach, gains.approach_brake);
        let linear = v * (T::HALF / k4 + T::ONE / gains.decay);
        let braking = v * v / (p + p) + p / (f(8.0) * k4 * k4) + v / gains.decay;
        let needed = if k4 * v > p && braking > linear {
            braking
        } else {
            linear
        };
        // Even from rest a goal this near is the parking law's business.
        let least = f(0.05);
        if needed > least { needed } else { least }
    }
}
