//! The end of every tick: wrench to wheel torques, limit, finite check.

use crate::error::StepFault;
use crate::params::Validated;
use crate::report::StepReport;
use crate::scalar::Scalar;
use crate::wheels::limit_torques;

/// Fills in the wheel torques; refuses a report whose torques or command rates are not finite.
#[inline]
pub(crate) fn report<T: Scalar>(
    params: &Validated<T>,
    mut report: StepReport<T>,
) -> Result<StepReport<T>, StepFault> {
    let asked = params.wheels.torques(&report.wrench);
    // The command rate drives a neuron next tick, so it must be finite as well.
    let rate = &report.command_rate;
    if !(asked.right.is_finite() && asked.left.is_finite() && rate.is_finite()) {
        return Err(StepFault::Overflow);
    }
    let (torques, saturated) = limit_torques(asked, params.torque_limit);
    report.torques = torques;
    report.notes.saturated = saturated;
    Ok(report)
}
