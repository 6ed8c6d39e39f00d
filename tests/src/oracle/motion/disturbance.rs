//! Section 8: the disturbance estimate.

use super::Pair;
use super::constants::Constants;

/// Share of the largest acceleration at which learning is half as fast.
const CALM: f64 = 0.05;

/// d̂, the last twist, and what the wheels exert if that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observer {
    /// d̂.
    pub d: Pair,
    /// (v, w) of the last tick.
    pub twist: Pair,
    /// F, N.
    pub exerted: Option<Pair>,
}

impl Observer {
    /// After `dt`; whether d̂ is at its bound. A parked robot that is let go forgets.
    pub fn advance(
        &mut self,
        k: &Constants,
        twist: &Pair,
        rate: &Pair,
        fades: bool,
        dt: f64,
    ) -> bool {
        let gained = k.inertia.component_mul(&(twist - self.twist));
        self.twist = *twist;
        let g = k.omega / (1.0 + k.omega * dt);
        if fades {
            self.d -= g * dt * self.d;
            return false;
        }
        let Some(exerted) = self.exerted else {
            return false;
        };
        let bound = k.disturbance_bound();
        // The smaller of both ways for the force.
        let calm = CALM * k.accel.inf(&k.brake);
        let mut at_bound = false;
        for i in 0..2 {
            let most = bound[i] * dt;
            let innovation = (gained[i] - dt * (exerted[i] + self.d[i])).clamp(-most, most);
            let free = self.d[i] + g * innovation;
            at_bound |= free.abs() > bound[i];
            let next = free.clamp(-bound[i], bound[i]);
            let change = next - self.d[i];
            let easy = change * rate[i] > 0.0 && next * rate[i] > 0.0;
            let patience = if easy {
                1.0 + (rate[i] / calm[i]).powi(2)
            } else {
                1.0
            };
            self.d[i] = if easy {
                self.d[i] + change / patience
            } else {
                next
            };
        }
        at_bound
    }
}
