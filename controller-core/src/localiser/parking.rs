//! What encoders and filtered fixes leave of parking.

use super::params::ValidLocaliserParams;
use crate::motion::{Arrival, HEADING_DEVIATIONS};
use crate::range::{larger, smaller};
use crate::scalar::Scalar;

impl<T: Scalar> ValidLocaliserParams<T> {
    /// What [`MotionParams::pose_noise_m`](crate::motion::MotionParams::pose_noise_m) has to be with
    /// this pose \[m\]: 0.6 of the filtered noise of the fixes, of at least 0.25 mm of it, and 0.29 of a count.
    pub fn pose_noise_m(&self) -> T {
        self.pose_noise
    }

    /// When a robot with this pose has arrived; the true pose is then off by that, and the noise.
    ///
    /// Distance: the noise radius, 3 σ_f: a manoeuvre aims at the goal itself, and what the pose wanders while it settles
    /// comes on top. Heading: `HEADING_DEVIATIONS` of σ_f and the turn of one count. With fixes at least 1 mm and 2 mrad, within which a new approach
    /// leads however well the pose is known. Dwell: with fixes their time constant, in which the pose loses two thirds of what it drifted by while the robot moved.
    /// Never less than [`Arrival::exact`], never more than 10 s.
    pub fn arrival(&self) -> Arrival<T> {
        let f = T::from_f64;
        let exact = Arrival::<T>::exact();
        let (settled_m, settled_rad) = self.settled;
        let distance = f(5.0) * self.pose_noise + settled_m;
        let heading = larger(exact.heading_rad, f(HEADING_DEVIATIONS) * settled_rad);
        let odometry = &self.params().odometry;
        Arrival {
            distance_m: larger(exact.distance_m, distance),
            heading_rad: heading + odometry.travel_per_count_m() / odometry.track_m(),
            dwell_s: match &self.params().fusion {
                Some(fusion) => {
                    let slower = smaller(fusion.bandwidth, fusion.heading_bandwidth);
                    smaller(T::ONE / slower, f(10.0))
                }
                None => exact.dwell_s,
            },
            ..exact
        }
    }
}
