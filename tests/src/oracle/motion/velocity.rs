//! Section 14: driving by velocity.

use std::f64::consts::{E, FRAC_PI_2};

use super::Pair;
use super::command::{Command, Desired, faded};
use super::constants::Constants;
use super::follow::wrapped;

/// T of a heading that is not held.
const MEMORY: f64 = 0.4;

/// The heading that is held, or remembered, what it adds to the turn rate, and the rate of that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heading {
    held: Option<f64>,
    added: f64,
    added_rate: f64,
}

impl Heading {
    /// The held heading goes on with w_s; what it is from where the robot looks.
    pub fn error(&mut self, command: &Command, theta: f64, dt: f64) -> f64 {
        let Some(held) = &mut self.held else {
            return 0.0;
        };
        let w = command.twist.y - self.added;
        let rate = command.rate.y - self.added_rate;
        *held = wrapped(*held + w * dt + rate * dt.powi(2) / 2.0);
        wrapped(*held - theta)
    }

    /// The setpoint after `dt`.
    #[allow(clippy::too_many_arguments)]
    pub fn desired(
        &mut self,
        k: &Constants,
        order: &Pair,
        hold: bool,
        (theta, turn_rate): (f64, f64),
        e: f64,
        command: &Command,
        jumped: bool,
        dt: f64,
    ) -> Desired {
        if jumped {
            *self = Self::default();
        }
        let to = k.reachable(order);
        let decay = Pair::repeat(E * k.jerk.component_div(&k.accel.sup(&k.brake)).min());
        let from = command.twist - Pair::new(0.0, self.added);
        let from_rate = command.rate - Pair::new(0.0, self.added_rate);
        let (gap, rate) = faded(&(from - to), &from_rate, &decay, dt);
        let lagged = to + gap;
        let moves = to != Pair::zeros() || lagged.amax() > 0.01;
        // e′ = −e/T, implicit.
        let fading = if hold { 0.0 } else { 1.0 / MEMORY };
        *self = if moves {
            let e = if self.held.is_some() {
                e.clamp(-FRAC_PI_2, FRAC_PI_2) / (1.0 + fading * dt)
            } else {
                0.0
            };
            Self {
                held: Some(theta + e),
                added: k.k3 * e.sin(),
                added_rate: k.k3 * e.cos() * (lagged.y - turn_rate - fading * e),
            }
        } else {
            Self::default()
        };
        Desired {
            twist: lagged + Pair::new(0.0, self.added),
            rate: rate + Pair::new(0.0, self.added_rate),
        }
    }
}
