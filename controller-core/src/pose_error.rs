//! The pose error as the robot sees it. Eqs. (7)-(9).

use crate::angle::wrap;
use crate::cast::cast;
use crate::maths::Maths;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Pose, Twist};

/// Reference minus robot, in the robot's frame: e_p = (e_x, e_y, e_θ)ᵀ of Eq. (8).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseError<T> {
    /// e_x \[m\]: positive if the reference is ahead.
    pub x: T,
    /// e_y \[m\]: positive if the reference is to the left.
    pub y: T,
    /// e_θ \[rad\] in (−π, π]: positive if the reference is turned counter-clockwise.
    pub theta: T,
}

cast!(PoseError { x, y, theta });

impl<T: Scalar> PoseError<T> {
    /// |(e_x, e_y, e_θ)| with metres and radians weighed alike, as the paper's settling times need.
    pub fn norm<M: Maths<T>>(&self) -> T {
        M::sqrt(self.x * self.x + self.y * self.y + self.theta * self.theta)
    }
}

/// World difference, then rotation into the body frame. Eqs. (7) and (8).
///
/// ```text
/// e_x =  (x_r − x) cos θ + (y_r − y) sin θ
/// e_y = −(x_r − x) sin θ + (y_r − y) cos θ
/// e_θ =   θ_r − θ, wrapped
/// ```
///
/// | symbol | argument | unit | frame |
/// | --- | --- | --- | --- |
/// | (x_r, y_r, θ_r) | `reference` | m, m, rad | world |
/// | (x, y, θ) | `pose` | m, m, rad | world |
/// | (e_x, e_y, e_θ) | result | m, m, rad | body |
///
/// Not in the paper: e_θ is wrapped. Single precision resolves 0.5 µm at 5 m and 0.5 mm at 10 km
/// from the origin; far away, subtract a common origin in double precision first.
#[inline(always)]
pub fn pose_error<T: Scalar, M: Maths<T>>(reference: &Pose<T>, pose: &Pose<T>) -> PoseError<T> {
    pose_error_and_heading::<T, M>(reference, pose).0
}

/// [`pose_error`], and the (sin θ, cos θ) that it takes.
#[inline(always)]
pub(crate) fn pose_error_and_heading<T: Scalar, M: Maths<T>>(
    reference: &Pose<T>,
    pose: &Pose<T>,
) -> (PoseError<T>, (T, T)) {
    let (sine, cosine) = M::sin_cos(pose.theta);
    let (dx, dy) = (reference.x - pose.x, reference.y - pose.y);
    let error = PoseError {
        x: dx * cosine + dy * sine,
        y: dy * cosine - dx * sine,
        theta: wrap(reference.theta - pose.theta),
    };
    (error, (sine, cosine))
}

/// [`pose_error`] and the (sin e_θ, cos e_θ) that tracking needs, at the price of one sine and cosine.
///
/// The world difference is turned by the reference's heading, which comes as a unit vector, and
/// then back by e_θ: θ = θ_r − e_θ.
///
/// ```text
/// X =  (x_r − x) cos θ_r + (y_r − y) sin θ_r        e_x = X cos e_θ − Y sin e_θ
/// Y = −(x_r − x) sin θ_r + (y_r − y) cos θ_r        e_y = X sin e_θ + Y cos e_θ
/// ```
#[inline(always)]
pub fn tracking_error<T: Scalar, M: Maths<T>>(
    reference: &Reference<T>,
    pose: &Pose<T>,
) -> (PoseError<T>, (T, T)) {
    let (from, heading) = (reference.pose(), reference.heading());
    let (dx, dy) = (from.x - pose.x, from.y - pose.y);
    let along = dx * heading.cos + dy * heading.sin;
    let across = dy * heading.cos - dx * heading.sin;
    let theta = wrap(from.theta - pose.theta);
    let (sine, cosine) = M::sin_cos_near(theta);
    let error = PoseError {
        x: along * cosine - across * sine,
        y: along * sine + across * cosine,
        theta,
    };
    (error, (sine, cosine))
}

/// Rate of change of the pose error. Eq. (9).
///
/// ```text
/// ė_x =  w e_y − v + v_r cos e_θ
/// ė_y = −w e_x     + v_r sin e_θ
/// ė_θ =  w_r − w
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | (sin e_θ, cos e_θ) | `heading` | |
/// | (v_r, w_r) | `reference` | m/s, rad/s |
/// | (v, w) | `twist` | m/s, rad/s |
#[inline(always)]
pub fn pose_error_rate<T: Scalar>(
    error: &PoseError<T>,
    heading: (T, T),
    reference: &Twist<T>,
    twist: &Twist<T>,
) -> PoseError<T> {
    let (sine, cosine) = heading;
    PoseError {
        x: twist.angular * error.y - twist.linear + reference.linear * cosine,
        y: reference.linear * sine - twist.angular * error.x,
        theta: reference.angular - twist.angular,
    }
}
