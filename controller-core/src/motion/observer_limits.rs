//! What the estimates of disturbance and load need of the limits.

use super::limits::Limits;
use super::load::LoadLimits;
use crate::range::smaller;
use crate::scalar::Scalar;
use crate::types::Accel;

/// Share of the largest acceleration at which the disturbance estimate learns half as fast: 8 cm/s² on a base of
/// 1.5 m/s², which the approach to a goal is below from 5 cm on.
const CALM: f64 = 0.05;

/// What the estimates need of the limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ObserverLimits<T> {
    pub(super) driving: LoadLimits<T>,
    pub(super) turning: LoadLimits<T>,
    /// a₀ of `disturbance::patient`.
    pub(super) calm: Accel<T>,
}

impl<T: Scalar> ObserverLimits<T> {
    pub(super) fn of(limits: &Limits<T>) -> Self {
        let accel = smaller(limits.accel, limits.brake);
        Self {
            driving: LoadLimits::of(accel, limits.jerk),
            turning: LoadLimits::of(limits.turn_accel, limits.turn_jerk),
            calm: Accel {
                linear: T::from_f64(CALM) * accel,
                angular: T::from_f64(CALM) * limits.turn_accel,
            },
        }
    }
}
