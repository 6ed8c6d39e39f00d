//! Pose and twist from wheel encoders.

use crate::error::{Field, ParamError};
use crate::hal::WheelCounts;
use crate::maths::Maths;
use crate::range::within;
use crate::reference::sinc;
use crate::scalar::Scalar;
use crate::types::{Measured, Pose, Twist};
use crate::wheels::WheelGeometry;

/// What odometry needs to know of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryParams<T> {
    /// Radii and distance of the wheels, as calibrated.
    pub wheels: WheelGeometry<T>,
    /// Encoder counts per turn of a wheel, after gears and quadrature: 1 to 1e7.
    pub counts_per_turn: T,
    /// Bandwidth of the speed estimate \[rad/s\], 1 to 1e4. Its delay is 2/bandwidth.
    pub bandwidth: T,
}

/// Wheel travel \[m\] and its rate \[m/s\], estimated by a second-order tracking loop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wheel<T> {
    /// Measured minus estimated travel: kept instead of both, so that it never grows.
    lag: T,
    speed: T,
}

/// Integrates encoder counts to a pose along exact arcs and estimates the twist.
///
/// The pose error of one step is zero for wheels that turn at constant rates in between. The speed
/// estimate is that of a loop tracking the wheel's travel with two equal poles at `bandwidth`: no
/// steady error at constant speed, a delay of 2/bandwidth, and at low speed, where a count spans
/// many ticks, a smooth curve instead of a train of spikes: one count moves it by
/// bandwidth² · dt · (travel per count) a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry<T> {
    right_per_count: T,
    left_per_count: T,
    track: T,
    bandwidth: T,
    counts: WheelCounts,
    right: Wheel<T>,
    left: Wheel<T>,
    pose: Pose<T>,
}

impl<T: Scalar> Odometry<T> {
    /// Starts at rest at `pose`, with the encoders at `counts`.
    ///
    /// # Errors
    /// The first parameter out of its range.
    pub fn new(
        params: &OdometryParams<T>,
        pose: Pose<T>,
        counts: WheelCounts,
    ) -> Result<Self, ParamError> {
        let wheels = &params.wheels;
        let right = within(Field::RadiusRight, wheels.radius_right_m, 1.0e-3, 10.0)?;
        let left = within(Field::RadiusLeft, wheels.radius_left_m, 1.0e-3, 10.0)?;
        let turn = within(Field::CountsPerTurn, params.counts_per_turn, 1.0, 1.0e7)?;
        let radians_per_count = (T::PI + T::PI) / turn;
        Ok(Self {
            right_per_count: right * radians_per_count,
            left_per_count: left * radians_per_count,
            track: within(Field::Track, wheels.track_m, 1.0e-2, 100.0)?,
            bandwidth: within(Field::Bandwidth, params.bandwidth, 1.0, 1.0e4)?,
            counts,
            right: Wheel::default(),
            left: Wheel::default(),
            pose,
        })
    }

    /// Moves the pose by what the wheels turned since the last call, `dt` > 0 \[s\] ago.
    ///
    /// Along an arc with turn φ the chord is d · sin(φ/2)/(φ/2) in direction θ + φ/2: Eq. (6) again.
    /// Counts wrap; a wheel turns less than 2³¹ counts between calls.
    pub fn update<M: Maths<T>>(&mut self, counts: WheelCounts, dt: T) -> Measured<T> {
        let moved =
            |now: i32, last: i32, per_count: T| T::from_i32(now.wrapping_sub(last)) * per_count;
        let right = moved(counts.right, self.counts.right, self.right_per_count);
        let left = moved(counts.left, self.counts.left, self.left_per_count);
        self.counts = counts;
        let (travel, turn) = (T::HALF * (right + left), (right - left) / self.track);
        let half_turn = T::HALF * turn;
        let (sine, cosine) = M::sin_cos(self.pose.theta + half_turn);
        let chord = travel * sinc::<T, M>(half_turn);
        self.pose = Pose {
            x: self.pose.x + chord * cosine,
            y: self.pose.y + chord * sine,
            theta: self.pose.theta + turn,
        };
        let right = self.right.track(right, self.bandwidth, dt);
        let left = self.left.track(left, self.bandwidth, dt);
        Measured {
            pose: self.pose,
            twist: Twist {
                linear: T::HALF * (right + left),
                angular: (right - left) / self.track,
            },
        }
    }

    /// Puts the robot elsewhere on the map. Speeds, and with them the torques' damping, carry on.
    pub fn set_pose(&mut self, pose: Pose<T>) {
        self.pose = pose;
    }

    /// The pose of the last update.
    pub fn pose(&self) -> &Pose<T> {
        &self.pose
    }
}

impl<T: Scalar> Wheel<T> {
    /// Critically damped loop, lag' = moved − v, v' = ω² lag with 2ω of damping, solved implicitly:
    /// stable for every ω dt, and exact at constant speed.
    fn track(&mut self, moved: T, bandwidth: T, dt: T) -> T {
        let a = bandwidth * dt;
        let one_plus = T::ONE + a;
        // The speed that leaves the loop's two poles at 1/(1 + a) each.
        let error = self.lag + moved - self.speed * dt;
        let shrink = T::ONE / (one_plus * one_plus);
        let speed = self.speed + bandwidth * (a * shrink) * error;
        self.lag = error * shrink;
        self.speed = speed;
        self.speed
    }
}
