//! The end of every tick: wrench to wheel torques, limit, finite check.

use crate::check::check_measured;
use crate::error::StepFault;
use crate::paper::demand::Demand;
use crate::paper::params::ValidParams;
use crate::scalar::Scalar;
use crate::types::{Accel, Measured, WheelTorques, Wrench};
use crate::wheels::limit_torques;

/// Wheel torques for a wrench, and whether they had to be limited.
///
/// Also the finite check of the whole tick: an input that is not a number makes the command rate
/// and the torques not numbers, so two comparisons, which NaN fails, stand for twelve. Which
/// input it was is found out afterwards.
#[inline(always)]
pub(crate) fn wheel_torques<T: Scalar>(
    params: &ValidParams<T>,
    wrench: &Wrench<T>,
    demand: &Demand<T>,
    measured: &Measured<T>,
) -> Result<(WheelTorques<T>, bool), StepFault> {
    let torques = params.wheels.torques(wrench);
    let limit = params.torque_limit;
    if torques.right.abs() <= limit && torques.left.abs() <= limit {
        Ok((torques, false))
    } else {
        beyond_limit(torques, limit, demand, measured)
    }
}

/// A command rate drives a neuron in the next tick, so it must be finite even where no torque of
/// this tick depends on it.
#[inline(always)]
pub(crate) fn check_rate<T: Scalar>(
    rate: &Accel<T>,
    demand: &Demand<T>,
    measured: &Measured<T>,
) -> Result<(), StepFault> {
    if rate.is_finite() {
        Ok(())
    } else {
        Err(culprit(demand, measured))
    }
}

#[cold]
#[inline(never)]
fn beyond_limit<T: Scalar>(
    torques: WheelTorques<T>,
    limit: T,
    demand: &Demand<T>,
    measured: &Measured<T>,
) -> Result<(WheelTorques<T>, bool), StepFault> {
    if torques.right.is_finite() && torques.left.is_finite() {
        Ok(limit_torques(torques, limit))
    } else {
        Err(culprit(demand, measured))
    }
}

/// The input that is not finite, or an overflow if all of them are.
#[cold]
fn culprit<T: Scalar>(demand: &Demand<T>, measured: &Measured<T>) -> StepFault {
    match check_measured(measured).and_then(|()| demand.check()) {
        Err(fault) => fault,
        Ok(()) => StepFault::Overflow,
    }
}
