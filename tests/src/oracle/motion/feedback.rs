//! Section 3: parking by feedback.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use super::Pair;
use super::command::Desired;
use super::constants::Constants;
use super::follow::wrapped;
use super::neuron::Neuron;

/// k_a and h.
const GAINS: (f64, f64) = (1.6, 0.4);
/// ζ of the bearing's pair.
const DAMPING: f64 = 0.8;
/// Bound of s₃ \[rad/s\].
const TURN_BOUND: f64 = 4.0;

/// s₁, s₃, which way the robot drives, β unrolled, and whether it aligns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Regulator {
    s: [Neuron; 2],
    /// 1 forward, −1 backward, 0 undecided.
    pub way: f64,
    beta: f64,
    aligns: bool,
}

/// α and β for a way of driving.
fn seen(way: f64, e: &Vector3<f64>) -> (f64, f64) {
    let alpha = (way * e.y).atan2(way * e.x);
    (alpha, wrapped(alpha - e.z))
}

/// α² + h β².
fn price((alpha, beta): (f64, f64)) -> f64 {
    alpha.powi(2) + GAINS.1 * beta.powi(2)
}

impl Regulator {
    /// The neurons rest.
    pub fn rest(&mut self) {
        self.s = [Neuron::default(); 2];
    }

    /// Towards an aim at `e`. `dt` is `None` where the law begins afresh from `command`.
    pub fn desired(
        &mut self,
        k: &Constants,
        e: &Vector3<f64>,
        command: &Pair,
        dt: Option<f64>,
    ) -> Desired {
        if dt.is_none() {
            (self.way, self.beta, self.aligns) = (0.0, 0.0, false);
        }
        let rho = e.x.hypot(e.y);
        let r0 = k.p / k.k4.powi(2);
        let gain = if rho <= r0 {
            k.k4
        } else {
            (2.0 * k.p * (rho - r0 / 2.0)).sqrt() / rho
        };
        let (alpha, beta) = self.view(e, command.x);
        let (k_a, h) = GAINS;
        let phi = (h * beta).atan();
        let phi_slope = h / (1.0 + (h * beta).powi(2));
        let turns = alpha.cos().max(0.2) * (k_a * (alpha + phi) + (1.0 + phi_slope) * alpha.sin());
        // The neuron makes s/(1 + |s|/B) of it, which is to be within the turn rate.
        let least = 1.0 / k.speed.y - 1.0 / TURN_BOUND;
        let gain = if least > 0.0 {
            gain.min(1.0 / (least * turns.abs()))
        } else {
            gain
        };
        let bearing = gain * turns;
        let share = self.aim_share(k, rho);
        let wanted = [gain * e.x, share * bearing + (1.0 - share) * k.k4 * e.z];
        let a = k.a.min((2.0 * DAMPING).powi(2) * (k_a + 1.0 + h) * k.k4);
        let bounds = [4.0 * k.k4, TURN_BOUND];
        self.s = match dt {
            Some(dt) => {
                std::array::from_fn(|i| self.s[i].after(wanted[i], a, bounds[i], dt, k.rule))
            }
            None => std::array::from_fn(|i| Neuron::at(command[i], wanted[i], a, bounds[i])),
        };
        Desired {
            twist: Pair::new(self.s[0].xi, self.s[1].xi),
            rate: Pair::new(self.s[0].rate(a, bounds[0]), self.s[1].rate(a, bounds[1])),
        }
    }

    /// How much of the turning is the bearing's: all from twice the noise radius on, none within it; with noise that is stated
    /// all or nothing.
    fn aim_share(&mut self, k: &Constants, rho: f64) -> f64 {
        let (near, noisy) = k.noise_radius();
        if noisy {
            let radii = if self.aligns { 5.0 } else { 1.5 };
            self.aligns = rho < radii * near;
            return if self.aligns { 0.0 } else { 1.0 };
        }
        let z = (rho / near - 1.0).clamp(0.0, 1.0);
        3.0 * z.powi(2) - 2.0 * z.powi(3)
    }

    fn view(&mut self, e: &Vector3<f64>, speed: f64) -> (f64, f64) {
        if self.way == 0.0 {
            let weighed = |way: f64| {
                let half = if way * speed > 0.05 { 0.5 } else { 1.0 };
                half * price(seen(way, e))
            };
            self.way = if weighed(1.0) <= weighed(-1.0) {
                1.0
            } else {
                -1.0
            };
        }
        let (mut now, other) = (seen(self.way, e), seen(-self.way, e));
        if now.0.abs() > 1.7 && price(other) < 0.7 * price(now) {
            self.way = -self.way;
            now = other;
        }
        // Across ±π, for a view that has just been there.
        if now.1 * self.beta < 0.0 && now.1.abs() > PI - 0.3 && self.beta.abs() > FRAC_PI_2 {
            now.1 += 2.0 * PI * self.beta.signum();
        }
        self.beta = now.1;
        now
    }
}
