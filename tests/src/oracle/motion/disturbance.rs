//! Section 8: the disturbance estimate, and the load.

use super::Pair;
use super::constants::{Constants, LARGEST_LOAD};

/// Share of the largest acceleration at which learning is half as fast.
const CALM: f64 = 0.05;

/// λ and T of the load.
const WINDOW: f64 = 5.0;
const BELIEF: f64 = 0.03;
/// Share of the largest gain from which on a load is learnt.
const TELLING: f64 = 0.1;

/// d̂, the last twist, and what the wheels exert if that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observer {
    /// d̂.
    pub d: Pair,
    /// (v, w) of the last tick.
    pub twist: Pair,
    /// F, N.
    pub exerted: Option<Pair>,
    /// σ.
    pub load: Pair,
    /// s/(s + λ) (v, w), and 1/(s + λ) of what the wheels exert over the stated inertia.
    pub window: [Pair; 2],
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
        let moved = twist - self.twist;
        self.twist = *twist;
        let g = k.omega / (1.0 + k.omega * dt);
        if fades {
            self.d -= g * dt * self.d;
        }
        let Some(exerted) = self.exerted.filter(|_| !fades) else {
            self.window = Default::default();
            return false;
        };
        self.weigh(k, &moved, &(exerted + self.d), dt);
        let loaded = k.inertia.component_mul(&self.load.add_scalar(1.0));
        let gained = loaded.component_mul(&moved);
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

    /// Weighted mean of the load that was believed and the one that the window tells, (q − x)/x; `push` is of wheels and d̂.
    fn weigh(&mut self, k: &Constants, moved: &Pair, push: &Pair, dt: f64) {
        let [x, q] = self.window;
        let whole = 1.0 + WINDOW * dt;
        let x = (x + moved) / whole;
        let q = (q + dt * push.component_div(&k.inertia)) / whole;
        self.window = [x, q];
        let accel = k.accel.inf(&k.brake);
        for i in 0..2 {
            let size = WINDOW * x[i].abs() / accel[i];
            let weight = dt * size * (size - TELLING).max(0.0);
            let implied = if weight > 0.0 {
                (q[i] - x[i]) / x[i]
            } else {
                0.0
            };
            let mean = (BELIEF * self.load[i] + weight * implied) / (BELIEF + weight);
            let most = LARGEST_LOAD * k.jerk[i] / accel[i] * dt;
            let step = (mean - self.load[i]).clamp(-most, most);
            self.load[i] = (self.load[i] + step).clamp(-LARGEST_LOAD, LARGEST_LOAD);
        }
    }
}
