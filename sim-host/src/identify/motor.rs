//! What a motor's current determines, in the fitted numbers.

use super::log::Drive;
use super::quantity::{Known, Quantity};
use super::wheels::DYNAMIC;

/// alpha and beta of a side, of logs with currents.
pub(super) fn alpha_beta(global: &[f64], i: usize) -> [f64; 2] {
    [global[DYNAMIC + 2 * i], global[DYNAMIC + 2 * i + 1]]
}

/// Back-EMF in commands per speed, D_e = beta/alpha.
pub(super) fn measured(global: &[f64], i: usize) -> f64 {
    let [alpha, beta] = alpha_beta(global, i);
    let damping = global[4 + i].abs();
    // It is a part of all damping; currents of nothing but noise must not spoil the motion. NaN is 0.
    (beta / alpha).max(0.0).min(2.0 * damping)
}

/// D_e as far as it is stated: k for voltages, k/supply for duties. A driver that controls torque
/// makes up for it.
pub(super) fn stated(drive: Drive, known: &Known) -> [Option<f64>; 2] {
    [Quantity::MotorConstantRight, Quantity::MotorConstantLeft].map(|constant| match drive {
        Drive::Torque => Some(0.0),
        Drive::Voltage => known.get(constant),
        Drive::Duty => Some(known.get(constant)? / known.get(Quantity::Supply)?),
    })
}
