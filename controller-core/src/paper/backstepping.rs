//! Plain backstepping: the laws that the neurons replace. Eqs. (10) and (13).
//!
//! The baseline that everybody asks about. Commands and torques jump at the start and at the
//! hand-over; [`crate::paper::plain`] is the complete controller.

use crate::paper::params::{ParkingGains, TrackingGains};
use crate::pose_error::{PoseError, pose_error_rate};
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist};

/// Speed and turn rate to ask for while tracking. Eq. (10).
///
/// ```text
/// v_c = k₁ e_x + v_r cos e_θ
/// w_c = w_r + k₂ v_r e_y + k₃ sin e_θ
/// ```
///
/// Symbols and units as in [`crate::paper::tracking::command`], with the errors themselves for s₁, s₂.
#[inline(always)]
pub fn tracking_command<T: Scalar>(
    gains: &TrackingGains<T>,
    reference: &Twist<T>,
    heading: (T, T),
    error: &PoseError<T>,
) -> Twist<T> {
    crate::paper::tracking::command(gains, reference, heading, error.x, error.y)
}

/// Rate of change of [`tracking_command`], by Eq. (9): analytic, never differenced.
///
/// ```text
/// v̇_c = k₁ ė_x + v̇_r cos e_θ − v_r sin e_θ (w_r − w)
/// ẇ_c = ẇ_r + k₂ (v̇_r e_y + v_r ė_y) + k₃ cos e_θ (w_r − w)
/// ```
#[inline(always)]
pub fn tracking_command_rate<T: Scalar>(
    gains: &TrackingGains<T>,
    reference: &Reference<T>,
    heading: (T, T),
    error: &PoseError<T>,
    twist: &Twist<T>,
) -> Accel<T> {
    let rate = pose_error_rate(error, heading, reference.twist(), twist);
    let drives = (rate.x, rate.y);
    crate::paper::tracking::command_rate(gains, reference, heading, twist.angular, error.y, drives)
}

/// Speed and turn rate to ask for while parking. Eq. (13).
///
/// ```text
/// v_c = k₄ e_x        w_c = k₅ sin e_θ
/// ```
#[inline(always)]
pub fn parking_command<T: Scalar>(
    gains: &ParkingGains<T>,
    heading: (T, T),
    error: &PoseError<T>,
) -> Twist<T> {
    crate::paper::parking::command(gains, error.x, heading)
}

/// Rate of change of [`parking_command`], by Eq. (9) with a reference at rest.
///
/// ```text
/// v̇_c = k₄ (w e_y − v)      ẇ_c = −k₅ cos(e_θ) w
/// ```
#[inline(always)]
pub fn parking_command_rate<T: Scalar>(
    gains: &ParkingGains<T>,
    heading: (T, T),
    error: &PoseError<T>,
    twist: &Twist<T>,
) -> Accel<T> {
    let rate = pose_error_rate(error, heading, &Twist::default(), twist);
    crate::paper::parking::command_rate(gains, heading, (rate.x, rate.theta))
}
