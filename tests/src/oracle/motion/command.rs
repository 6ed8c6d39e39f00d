//! Sections 4 to 6: transition offset, governor, torque, saturation.

use nalgebra::Vector2;

use super::Pair;
use super::constants::{COMMAND_SHARE, Constants, Policy};

/// What a law wants: (v_d, w_d) and (a_d, α_d).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Desired {
    /// \[m/s, rad/s\].
    pub twist: Pair,
    /// \[m/s², rad/s²\].
    pub rate: Pair,
}

/// (v_c, w_c) and (a_c, α_c).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// \[m/s, rad/s\].
    pub twist: Pair,
    /// \[m/s², rad/s²\].
    pub rate: Pair,
}

/// The limits that were at work: speed, acceleration, jerk.
pub type AtWork = [bool; 3];

/// b and ḃ of b̈ + 2 A ḃ + A² b = 0 after `dt`, axis by axis.
pub fn faded(b: &Pair, rate: &Pair, a: &Pair, dt: f64) -> (Pair, Pair) {
    let fade = a.map(|a| (-a * dt).exp());
    let q = rate + a.component_mul(b);
    (
        (b + q * dt).component_mul(&fade),
        (rate - a.component_mul(&q) * dt).component_mul(&fade),
    )
}

/// The offset that continues a command, after `dt`, with the share `kept` of its rate.
pub fn offset(command: &Command, desired: &Desired, kept: f64, dt: f64) -> (Pair, Pair) {
    let rate = kept * (command.rate - desired.rate);
    (
        command.twist + dt * (desired.rate + rate) - desired.twist,
        rate,
    )
}

/// Each of `value` within ± `most`.
pub fn within(value: &Pair, most: &Pair) -> Pair {
    value.inf(most).sup(&-most)
}

/// The factors of force and moment with which wheels are within ± `limit`, both 1 if they are anyway.
pub fn share(k: &Constants, wrench: &Pair, limit: f64) -> Pair {
    let to_wheels = k
        .wheels_to_wrench()
        .try_inverse()
        .expect("wheels of some size");
    let asked: Vector2<f64> = to_wheels * wrench;
    if asked.amax() <= limit {
        return Pair::repeat(1.0);
    }
    let parts = [Pair::new(wrench.x, 0.0), Pair::new(0.0, wrench.y)];
    let yields = match k.policy {
        Policy::KeepCurvature => return Pair::repeat(limit / asked.amax()),
        Policy::TurnFirst => 0,
        Policy::DriveFirst => 1,
    };
    let served: Vector2<f64> = to_wheels * parts[1 - yields];
    let first = (limit / served.amax()).min(1.0);
    let taken = first * served;
    let more: Vector2<f64> = to_wheels * parts[yields];
    // The largest factor with |taken + factor · more| ≤ limit at both wheels.
    let rest = (0..2)
        .filter(|&i| more[i] != 0.0)
        .map(|i| (limit - taken[i] * more[i].signum()).max(0.0) / more[i].abs())
        .fold(1.0, f64::min);
    let mut factors = Pair::repeat(first);
    factors[yields] = rest;
    factors
}

impl Command {
    /// That of a robot that moves so already, as far as limits allow.
    pub fn of_robot(k: &Constants, twist: &Pair) -> Self {
        Self {
            twist: k.reachable(twist),
            rate: Pair::zeros(),
        }
    }

    /// Section 5. Whether the setpoint is `reduced` to what a rim may do is said where it is a tie.
    pub fn after(
        &self,
        k: &Constants,
        to: &Desired,
        reduced: Option<bool>,
        dt: f64,
    ) -> (Self, AtWork) {
        // A setpoint that asks too much of a wheel keeps its arc; rates that add to it are 0.
        let reduced = reduced.unwrap_or(k.rim(&to.twist) > k.rim_speed);
        let to = &if reduced {
            let share = k.rim_speed / k.rim(&to.twist);
            Desired {
                twist: k.reachable(&to.twist),
                rate: self
                    .within_accel(k, &to.rate)
                    .zip_map(&to.twist, |a, v| if a * v > 0.0 { 0.0 } else { share * a }),
            }
        } else {
            *to
        };
        let needed = (to.twist - self.twist) / dt;
        let allowed = self.within_accel(k, &needed);
        let factors = share(
            k,
            &k.inertia.component_mul(&allowed),
            COMMAND_SHARE * k.torque,
        );
        let r = factors.component_mul(&allowed);
        let moved = self.twist + r * dt;
        let each = within(&moved, &k.speed);
        // What both have gained since the last tick shrinks by one factor, until the rim is at its limit.
        let lever = Pair::new(1.0, k.track / 2.0);
        let gained = (each.abs() - self.twist.abs()).sup(&Pair::zeros());
        let excess = k.rim(&each) - k.rim_speed;
        let lost = (excess / gained.dot(&lever)).min(1.0) * gained;
        let twist = if excess > 0.0 {
            each - lost.component_mul(&each.map(f64::signum))
        } else {
            each
        };
        let mut fed = Pair::zeros();
        let (mut slewed, mut jerked) = (false, false);
        for i in 0..2 {
            let clipped = r[i] != needed[i];
            slewed |= clipped;
            let rate = if clipped { r[i] } else { to.rate[i] };
            let rate = rate + (twist[i] - each[i]) / dt;
            let outward = to.twist[i].abs() >= k.speed[i] && rate * to.twist[i] > 0.0;
            fed[i] = if outward { 0.0 } else { rate };
        }
        let fed = self.within_accel(k, &fed);
        let mut rate = fed;
        for i in 0..2 {
            let step = k.jerk[i] * dt;
            rate[i] = fed[i].clamp(self.rate[i] - step, self.rate[i] + step);
            jerked |= rate[i] != fed[i];
        }
        (
            Self { twist, rate },
            [reduced || twist != moved, slewed, jerked],
        )
    }

    /// Braking is towards rest.
    pub fn within_accel(&self, k: &Constants, rate: &Pair) -> Pair {
        let v = self.twist.x;
        let most = |direction: f64| {
            if v * direction < 0.0 {
                k.brake.x
            } else {
                k.accel.x
            }
        };
        Pair::new(
            rate.x.clamp(-most(-1.0), most(1.0)),
            rate.y.clamp(-k.accel.y, k.accel.y),
        )
    }
}

/// Section 6: m a_c − κ m (v − v_c) − d, both axes.
pub fn wrench(k: &Constants, command: &Command, twist: &Pair, (d, load): (&Pair, &Pair)) -> Pair {
    let fed = command.rate.component_mul(&load.add_scalar(1.0));
    let wanted = fed - k.kappa.component_mul(&(twist - command.twist));
    k.inertia.component_mul(&wanted) - d
}

/// The command that would have asked for just `exerted`.
pub fn set_back(
    k: &Constants,
    command: &Command,
    twist: &Pair,
    exerted: &Pair,
    (d, load): (&Pair, &Pair),
) -> Pair {
    let caused = (exerted + d).component_div(&k.inertia);
    let fed = command.rate.component_mul(&load.add_scalar(1.0));
    let v = twist + (caused - fed).component_div(&k.kappa);
    k.reachable(&v)
}
