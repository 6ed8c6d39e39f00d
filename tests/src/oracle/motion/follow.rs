//! Section 2: following.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use nalgebra::{Rotation2, Vector2, Vector3};

use super::constants::Constants;
use super::neuron::Neuron;
use super::{Pair, command::Desired};

/// Bound of s₃.
const AROUND: f64 = 1.5;
/// Share of the angular acceleration that it brakes with.
const BRAKING: f64 = 0.8;
/// Next to half a turn, where the side is kept \[rad\].
const KEPT: f64 = 0.3;

/// s₁, s₂, s₃ and the side that a robot turns to which looks back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Follower {
    s: [Neuron; 3],
    side: f64,
}

/// A reference: posture, twist, acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// (x, y, θ).
    pub q: Vector3<f64>,
    /// (v_r, w_r).
    pub twist: Pair,
    /// (a_r, α_r).
    pub accel: Pair,
}

/// (e_x, e_y, e_θ), e_θ in (−π, π].
pub fn error(target: &Vector3<f64>, robot: &Vector3<f64>) -> Vector3<f64> {
    let away = Vector2::new(target.x - robot.x, target.y - robot.y);
    let seen = Rotation2::new(-robot.z) * away;
    Vector3::new(seen.x, seen.y, wrapped(target.z - robot.z))
}

/// In (−π, π].
pub fn wrapped(angle: f64) -> f64 {
    let turns = ((angle - PI) / (2.0 * PI)).ceil();
    angle - 2.0 * PI * turns
}

/// What a base turns by until it stands that turns at `rate`: it brakes at p down to p/k₃, and from there with a time constant of 1/k₃.
fn stopping_way(k: &Constants, rate: f64) -> f64 {
    let p = BRAKING * k.turning_reach();
    let fading = rate.abs().min(p / k.k3);
    let braked = (rate.powi(2) - fading.powi(2)) / (2.0 * p);
    (fading / k.k3 + braked).copysign(rate)
}

/// The rate whose stopping way is `error`, and its derivative: by energy, w² = (p/k₃)² + 2p (e − p/k₃²).
fn turn_demand(k: &Constants, error: f64) -> (f64, f64) {
    let p = BRAKING * k.turning_reach();
    let knee = p / k.k3;
    let braked = error.abs() - knee / k.k3;
    if braked <= 0.0 {
        return (k.k3 * error, k.k3);
    }
    let rate = knee.hypot((2.0 * p * braked).sqrt());
    (rate.copysign(error), p / rate)
}

impl Follower {
    /// The desired twist and its rate. `dt` is `None` where the neurons restart from `command`.
    pub fn desired(
        &mut self,
        k: &Constants,
        reference: &Sample,
        e: &Vector3<f64>,
        turn_rate: f64,
        command: &Pair,
        dt: Option<f64>,
    ) -> Desired {
        let (v_r, w_r) = (reference.twist.x, reference.twist.y);
        let steep = 2.0 * FRAC_PI_4.sin();
        let g = k.c / k.k3 * v_r / (v_r.powi(2) + k.v_f.powi(2));
        let aside = (g * e.y / 1.0_f64.hypot(g * e.x)).clamp(-steep, steep);
        if e.z.abs() <= FRAC_PI_2 {
            self.side = 0.0;
        } else if self.side == 0.0 || PI - e.z.abs() > KEPT {
            self.side = e.z.signum();
        }
        let lacking = if self.side == 0.0 {
            0.0
        } else {
            self.side - e.z.sin()
        };
        let wanted = [k.k1 * e.x, aside, lacking];
        let bounds = [k.b_v, steep, AROUND];
        self.s = match dt {
            Some(dt) => {
                std::array::from_fn(|i| self.s[i].after(wanted[i], k.a, bounds[i], dt, k.rule))
            }
            None => {
                let from = [
                    command.x - v_r * e.z.cos(),
                    stopping_way(k, command.y - w_r) - e.z.sin(),
                    0.0,
                ];
                std::array::from_fn(|i| Neuron::at(from[i], wanted[i], k.a, bounds[i]))
            }
        };
        let rate: [f64; 3] = std::array::from_fn(|i| self.s[i].rate(k.a, bounds[i]));
        let turning = w_r - turn_rate;
        let (turn, per_error) = turn_demand(k, self.s[1].xi + e.z.sin() + self.s[2].xi);
        Desired {
            twist: Pair::new(self.s[0].xi + v_r * e.z.cos(), w_r + turn),
            rate: Pair::new(
                rate[0] + reference.accel.x * e.z.cos() - v_r * e.z.sin() * turning,
                reference.accel.y + per_error * (rate[1] + rate[2] + e.z.cos() * turning),
            ),
        }
    }
}
