//! What the fitted numbers are made of.

use super::log::Drive;
use super::quantity::{COUNT, Quantity};
use nalgebra::DMatrix;

/// Numbers that the fits can give: r_R, r_L, 1/l; E by rows, D, s; alpha, beta right, then left.
pub(super) const MEASURED: usize = 15;
/// Those of the poses, of the motion, of the currents.
pub(super) const POSES: std::ops::Range<usize> = 0..3;
pub(super) const MOTION: std::ops::Range<usize> = 3..11;
pub(super) const CURRENTS: std::ops::Range<usize> = 11..15;

/// The numbers from the quantities, in their order.
///
/// With v = (r_R w_R + r_L w_L)/2, turn rate (r_R w_R - r_L w_L)/l, the kinetic energy of body and
/// wheels gives the inertia seen by the wheels
///
/// ```text
/// M_RR = r_R^2 (m/4 + I/l^2) + J,  M_RL = r_R r_L (m/4 - I/l^2),  M_LL = r_L^2 (m/4 + I/l^2) + J
/// ```
///
/// and a motor the torque k (u U - k w)/R for a command u of scale U (1 V, or the supply for a
/// duty). Divided by the torque per command g = k U/R (1 for torques):
/// E = M/g, D = (c + k^2/R)/g, s = T/g, alpha = U/R, beta = k/R (1/k and 0 for torques).
pub(super) fn predict(drive: Drive, q: &[f64; COUNT]) -> [f64; MEASURED] {
    let [
        r,
        l,
        track,
        mass,
        inertia,
        wheel,
        k_r,
        k_l,
        res_r,
        res_l,
        c_r,
        c_l,
        t_r,
        t_l,
        supply,
    ] = *q;
    let (sum, difference) = (0.25 * mass, inertia / (track * track));
    let own = sum + difference;
    let shared = r * l * (sum - difference);
    let [motor_r, motor_l] = [(k_r, res_r), (k_l, res_l)].map(|(k, res)| match drive {
        Drive::Torque => (1.0, 0.0, 1.0 / k, 0.0),
        Drive::Voltage => (k / res, k * k / res, 1.0 / res, k / res),
        Drive::Duty => (k * supply / res, k * k / res, supply / res, k / res),
    });
    let (g_r, drag_r, alpha_r, beta_r) = motor_r;
    let (g_l, drag_l, alpha_l, beta_l) = motor_l;
    [
        r,
        l,
        1.0 / track,
        (r * r * own + wheel) / g_r,
        shared / g_r,
        shared / g_l,
        (l * l * own + wheel) / g_l,
        (c_r + drag_r) / g_r,
        (c_l + drag_l) / g_l,
        t_r / g_r,
        t_l / g_l,
        alpha_r,
        beta_r,
        alpha_l,
        beta_l,
    ]
}

/// Quantities as they are searched: the logarithm of what is positive, friction over a typical size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) drive: Drive,
    /// Viscous and Coulomb friction that counts as 1.
    pub(super) viscous: f64,
    pub(super) coulomb: f64,
}

impl Chart {
    pub(super) fn unit(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::ViscousRight | Quantity::ViscousLeft => self.viscous,
            _ => self.coulomb,
        }
    }

    /// The value at coordinate `x`.
    pub(super) fn value(&self, quantity: Quantity, x: f64) -> f64 {
        match quantity.is_friction() {
            true => x * self.unit(quantity),
            false => x.exp(),
        }
    }

    /// The coordinate of a value. A wheel inertia of nothing is a very small one.
    pub(super) fn coordinate(&self, quantity: Quantity, value: f64) -> f64 {
        match quantity.is_friction() {
            true => value / self.unit(quantity),
            false => value.max(1.0e-30).ln(),
        }
    }

    pub(super) fn values(&self, x: &[f64; COUNT]) -> [f64; COUNT] {
        Quantity::ALL.map(|q| self.value(q, x[q.index()]))
    }

    /// Derivatives of the numbers by the coordinates, by central differences: good to 1e-9.
    pub(super) fn derivatives(&self, x: &[f64; COUNT]) -> DMatrix<f64> {
        const STEP: f64 = 1.0e-5;
        let mut rows = DMatrix::zeros(MEASURED, COUNT);
        for i in 0..COUNT {
            let at = |step: f64| {
                let mut x = *x;
                x[i] += step;
                predict(self.drive, &self.values(&x))
            };
            let (up, down) = (at(STEP), at(-STEP));
            for j in 0..MEASURED {
                rows[(j, i)] = (up[j] - down[j]) / (2.0 * STEP);
            }
        }
        rows
    }
}
