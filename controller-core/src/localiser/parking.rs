//! What encoders and filtered fixes leave of parking.

use super::params::Localisation;
use crate::maths::Maths;
use crate::motion::Arrival;
use crate::odometry::OdometryParams;
use crate::scalar::Scalar;

/// Noise of the parking law per standard deviation of the filtered noise; its radius is 5 of them, so
/// 3 σ_f.
///
/// The law's radius is meant for noise that is new at every tick, of which its neurons let a sixth
/// through: √(A dt/2) at 5 1/s and 10 ms. Filtered noise is slower than the neurons and passes whole,
/// but so is the robot, which follows it instead of trembling. Inside 1.5 radii the law gives up the direction
/// to the goal, so the radius has to hold what the filter wanders within the seconds of an approach. With filters
/// of 0.2, 0.8, 3 rad/s a radius of 1 σ_f parks all of 16 runs too, within 2.5 instead of 3.0 mm, but up to 1.5 s later.
/// More than 3 only leaves the robot farther beside its goal.
const COLOUR: f64 = 0.6;

/// Standard deviation of an encoder's rounding, 1/√12 of a count.
const ROUNDING: f64 = 0.288_675;

/// σ of the parking law \[m\]: fixes and encoders, which know nothing of each other.
pub(super) fn pose_noise<T: Scalar, M: Maths<T>>(odometry: &OdometryParams<T>, filtered: T) -> T {
    let fixes = T::from_f64(COLOUR) * filtered;
    let counts = T::from_f64(ROUNDING) * odometry.travel_per_count_m();
    M::sqrt(fixes * fixes + counts * counts)
}

impl<T: Scalar> Localisation<T> {
    /// What [`MotionParams::pose_noise_m`](crate::motion::MotionParams::pose_noise_m) has to be with
    /// this pose \[m\]: 0.6 of the filtered noise of the fixes, and 0.29 of a count.
    pub fn pose_noise_m(&self) -> T {
        self.pose_noise
    }

    /// When a robot with this pose has arrived; the true pose is then off by that, and the noise.
    ///
    /// Distance: the noise radius and 2 σ_f, 5 σ_f in all: the law aligns at 1.5 radii, and less ends most runs in a
    /// new approach. Heading: 8 σ_f, since a parked robot is pushed off only
    /// at 1.3 times the tolerance and noise must not do it, and the turn of one count. Dwell: with
    /// fixes 1 s, in which the heading, for which the law goes on, loses two thirds of what is left.
    /// Never less than [`Arrival::exact`].
    pub fn arrival(&self) -> Arrival<T> {
        let f = T::from_f64;
        let exact = Arrival::<T>::exact();
        let larger = |a: T, b: T| if a > b { a } else { b };
        let distance = f(5.0) * self.pose_noise + f(2.0) * self.filtered_noise_m();
        let heading = larger(exact.heading_rad, f(8.0) * self.filtered_noise_rad());
        let odometry = &self.params().odometry;
        Arrival {
            distance_m: larger(exact.distance_m, distance),
            heading_rad: heading + odometry.travel_per_count_m() / odometry.track_m(),
            dwell_s: if self.fusion.is_some() {
                T::ONE
            } else {
                exact.dwell_s
            },
            ..exact
        }
    }
}
