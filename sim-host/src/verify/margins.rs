//! Certificates by numbers: how fast deviations from a reference die out, over speed and turn rate, and how many starts are lost.

use controller_core::angle::wrap;
use controller_core::maths::Libm;
use controller_core::motion::{Limits, MotionController, MotionGains, MotionParams, Task};
use controller_core::reference::ConstantTwist;
use controller_core::shunting::RationalMean;
use controller_core::types::{Measured, Pose, Twist};
use nalgebra::SMatrix;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::fmt;

use crate::mission::BaseSpec;
use crate::rate::Rate;

/// Shares of the largest speed and of the largest turn rate at which a reference is looked at.
const SPEEDS: [f64; 6] = [0.05, 0.1, 0.25, 0.5, 0.75, 0.95];
const TURNS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 0.95];
/// True mass and inertia over those that are believed.
const RATIOS: [f64; 3] = [0.7, 1.0, 1.3];

/// With less damping than this a robot weaves for long.
pub const WEAVES: f64 = 0.1;

/// Following at constant speed and turn rate, linearised: (e_x, e_y, e_θ, v, w, s₁, s₂, d_F/m, d_N/I), the last two of the
/// disturbance estimate. With μ the true over the believed mass:
///
/// ```text
/// ė_x = w_r e_y − v      ė_y = v_r e_θ − w_r e_x      ė_θ = −w
/// ṡ₁ = A (k₁ e_x − s₁)   ṡ₂ = A (g e_y − s₂)          g = (c/k₃) v_r/(v_r² + v_f²)
/// μ v̇ = ṡ₁ − κ₁ (v − s₁) − d_F/m                      μ ẇ = k₃ (ṡ₂ − w) − κ₂ (w − k₃ (s₂ + e_θ)) − d_N/I
/// ḋ = ω (v̇ − what is asked of the wheels without d)
/// ```
fn linearised(gains: &MotionGains<f64>, twist: (f64, f64), ratio: f64) -> SMatrix<f64, 9, 9> {
    let (v_r, w_r) = twist;
    let MotionGains {
        decay: a,
        longitudinal: k1,
        heading: k3,
        lateral: c,
        slow,
        speed_loop,
        turn_loop,
        disturbance,
        ..
    } = *gains;
    let g = c / k3 * v_r / (v_r * v_r + slow * slow);
    let mut m = SMatrix::<f64, 9, 9>::zeros();
    (m[(0, 1)], m[(0, 3)]) = (w_r, -1.0);
    (m[(1, 0)], m[(1, 2)]) = (-w_r, v_r);
    m[(2, 4)] = -1.0;
    (m[(5, 0)], m[(5, 5)]) = (a * k1, -a);
    (m[(6, 1)], m[(6, 6)]) = (a * g, -a);
    let mut asked = SMatrix::<f64, 2, 9>::zeros();
    for column in 0..9 {
        asked[(0, column)] = m[(5, column)];
        asked[(1, column)] = k3 * m[(6, column)];
    }
    asked[(0, 3)] -= speed_loop;
    asked[(0, 5)] += speed_loop;
    asked[(1, 2)] += turn_loop * k3;
    asked[(1, 4)] -= k3 + turn_loop;
    asked[(1, 6)] += turn_loop * k3;
    for axis in 0..2 {
        for column in 0..9 {
            m[(3 + axis, column)] = asked[(axis, column)] / ratio;
        }
        m[(3 + axis, 7 + axis)] -= 1.0 / ratio;
        for column in 0..9 {
            m[(7 + axis, column)] = disturbance * (m[(3 + axis, column)] - asked[(axis, column)]);
        }
    }
    m
}

/// How fast the slowest mode decays \[1/s\], and how well the worst pair of modes is damped.
fn slowest(matrix: &SMatrix<f64, 9, 9>) -> (f64, f64) {
    let (mut decay, mut damping) = (f64::INFINITY, 1.0_f64);
    for root in matrix.complex_eigenvalues().iter() {
        decay = decay.min(-root.re);
        if root.im != 0.0 {
            damping = damping.min(-root.re / root.norm());
        }
    }
    (decay, damping)
}

/// A reference, and what is known of following it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// \[m/s\].
    pub speed: f64,
    /// \[rad/s\].
    pub turn_rate: f64,
    /// Rate at which the slowest mode decays, with the masses as believed and the worst of ±30 % \[1/s\].
    pub decay: (f64, f64),
    /// Damping of the worst pair of modes, with the masses as believed and the worst of ±30 %.
    pub damping: (f64, f64),
}

/// Over all speeds and curvatures of a base.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityMap {
    /// Row by row: speeds, in each all turn rates.
    pub places: Vec<Place>,
    /// Starts within 2 m and any heading that were lost.
    pub lost: Rate,
}

impl StabilityMap {
    /// Of a base, with so many random starts.
    pub fn of(base: &BaseSpec, starts: usize, seed: u64) -> Self {
        let params = base.motion();
        let limits = &params.limits;
        let places = SPEEDS
            .iter()
            .flat_map(|v| {
                TURNS
                    .iter()
                    .map(move |w| (v * limits.speed, w * limits.turn_rate))
            })
            .map(|(speed, turn_rate)| {
                let of = |ratio| slowest(&linearised(&params.gains, (speed, turn_rate), ratio));
                let all = RATIOS.map(of);
                let least = |pick: fn(&(f64, f64)) -> f64| {
                    all.iter().map(pick).fold(f64::INFINITY, f64::min)
                };
                Place {
                    speed,
                    turn_rate,
                    decay: (all[1].0, least(|found| found.0)),
                    damping: (all[1].1, least(|found| found.1)),
                }
            })
            .collect();
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut draw = |scale: f64| scale * (2.0 * random.random::<f64>() - 1.0);
        let failed = (0..starts)
            .filter(|_| {
                let start = Pose::new(draw(2.0), draw(2.0), draw(std::f64::consts::PI));
                let share = 0.55 + draw(0.35);
                let turn = draw(0.4);
                !converges(&params, base.period_s(), start, (share, turn))
            })
            .count();
        Self {
            places,
            lost: Rate {
                failed,
                runs: starts,
            },
        }
    }

    /// Damping of the worst pair of modes anywhere, with masses of ±30 %.
    pub fn least_damping(&self) -> f64 {
        let damping = self.places.iter().map(|place| place.damping.1);
        damping.fold(1.0, f64::min)
    }

    /// The place whose slowest mode is the slowest with masses of ±30 %.
    pub fn worst(&self) -> Option<&Place> {
        self.places
            .iter()
            .min_by(|a, b| a.decay.1.total_cmp(&b.decay.1))
    }
}

/// Longest time to get on the path \[s\].
const LONGEST_S: f64 = 120.0;

/// Whether the law itself, on a robot as it is believed to be, gets from `start` at rest within 5 cm and 0.1 rad of a reference
/// from the origin with these shares of the largest speed and turn rate, and of the rims' speed at most 0.9, and is there 2 s later.
fn converges(
    params: &MotionParams<f64>,
    period_s: f64,
    start: Pose<f64>,
    shares: (f64, f64),
) -> bool {
    let Ok(motion) = params.validate() else {
        return false;
    };
    let limits = &params.limits;
    let twist = Twist::new(shares.0 * limits.speed, shares.1 * limits.turn_rate);
    // A base catches up with what leaves its rims a tenth of their speed.
    let leaving = Limits {
        rim_speed: 0.9 * limits.rim_speed,
        ..*limits
    };
    let path = ConstantTwist {
        start: Pose::default(),
        twist: leaving.reachable(&twist, params.robot.wheels.track_m),
    };
    let at = |t: f64| Task::Follow(path.at::<Libm>(t));
    let mut now = Measured {
        pose: start,
        twist: Twist::default(),
    };
    let started = MotionController::<f64, Libm, RationalMean>::start(&motion, &at(0.0), &now);
    let Ok(mut controller) = started else {
        return false;
    };
    let (mut inside_s, mut t) = (0.0, 0.0);
    while t < LONGEST_S {
        let wrench = motion.wheels().wrench(&controller.report().torques);
        let (a, alpha) = (
            wrench.force / params.robot.mass_kg,
            wrench.moment / params.robot.inertia_kg_m2,
        );
        // The middle of the tick: wrong by the tick to the third power.
        let (v, w) = (now.twist.linear, now.twist.angular);
        let half = 0.5 * period_s;
        let (sine, cosine) = (now.pose.theta + half * (w + half * alpha / 2.0)).sin_cos();
        let way = period_s * (v + half * a);
        now.pose.x += way * cosine;
        now.pose.y += way * sine;
        now.pose.theta = wrap(now.pose.theta + period_s * (w + half * alpha));
        now.twist = Twist::new(v + period_s * a, w + period_s * alpha);
        t += period_s;
        let Ok(report) = controller.step(period_s, &at(t), &now) else {
            return false;
        };
        let error = &report.error;
        let there = error.x.hypot(error.y) < 0.05 && error.theta.abs() < 0.1;
        inside_s = if there { inside_s + period_s } else { 0.0 };
        if inside_s > 2.0 {
            return true;
        }
    }
    false
}

impl fmt::Display for StabilityMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "following, linearised: decay of the slowest mode [1/s] at speed (down) and turn rate (across); with masses \u{b1}30 %"
        )?;
        write!(f, "{:>10}", "m/s, rad/s")?;
        for place in self.places.iter().take(TURNS.len()) {
            write!(f, "{:>14.2}", place.turn_rate)?;
        }
        for row in self.places.chunks(TURNS.len()) {
            let speed = row.first().map_or(0.0, |place| place.speed);
            write!(f, "\n{speed:>10.2}")?;
            for place in row {
                write!(
                    f,
                    "{:>14}",
                    format!("{:.2}; {:.2}", place.decay.0, place.decay.1)
                )?;
            }
        }
        writeln!(f, "\nleast damping {:.2}", self.least_damping())?;
        write!(
            f,
            "starts within 2 m, any heading, 20 to 90 % of the speed, that did not get on the path: {}",
            self.lost
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::BuiltInBase;
    use controller_core::tuning::motion::margins;

    fn bases() -> impl Iterator<Item = BaseSpec> {
        ["paper-30kg", "lab-10kg", "hobby-1kg"]
            .into_iter()
            .filter_map(|name| BuiltInBase::find(name)?.base().ok())
    }

    /// On a straight line well above the floor v_f the map is what the core's own polynomials say, which are in factors of their own.
    #[test]
    fn the_map_is_the_polynomials_on_a_fast_straight_line() {
        let mut checked = 0;
        for base in bases() {
            let gains = MotionGains {
                slow: 1.0e-4,
                ..base.motion().gains
            };
            let (decay, _) = slowest(&linearised(&gains, (base.limits.speed, 0.0), 1.0));
            let expected = margins::<f64, Libm>(&gains);
            let least = expected.longitudinal.decay.min(expected.lateral.decay);
            assert!((decay - least).abs() < 1.0e-4 * least, "{decay} {least}");
            checked += 1;
        }
        assert_eq!(checked, 3);
    }

    /// What the law itself does near a reference decays as the map says, within what ticks of 1 ms and a neuron's curve make of it.
    #[test]
    fn the_law_decays_as_the_map_says() {
        for base in bases() {
            let params = base.motion();
            let Ok(motion) = params.validate() else {
                panic!("a built-in base is valid");
            };
            for (v, w) in [(0.3, 0.0), (0.3, 0.4)] {
                let twist = Twist::new(v * params.limits.speed, w * params.limits.turn_rate);
                let path = ConstantTwist {
                    start: Pose::default(),
                    twist,
                };
                let dt = 1.0e-3;
                let run = |offset: f64| {
                    let mut now = Measured {
                        pose: Pose::new(offset, offset, 0.0),
                        twist,
                    };
                    let task = |t: f64| Task::Follow(path.at::<Libm>(t));
                    let mut law = MotionController::<f64, Libm, RationalMean>::start(
                        &motion,
                        &task(0.0),
                        &now,
                    )
                    .expect("finite");
                    let mut errors = Vec::new();
                    for k in 1..=20_000_u32 {
                        let wrench = motion.wheels().wrench(&law.report().torques);
                        let a = wrench.force / params.robot.mass_kg;
                        let alpha = wrench.moment / params.robot.inertia_kg_m2;
                        let (v, w) = (now.twist.linear, now.twist.angular);
                        let middle = now.pose.theta + 0.5 * dt * (w + 0.25 * dt * alpha);
                        now.pose.x += dt * (v + 0.5 * dt * a) * middle.cos();
                        now.pose.y += dt * (v + 0.5 * dt * a) * middle.sin();
                        now.pose.theta += dt * (w + 0.5 * dt * alpha);
                        now.twist = Twist::new(v + dt * a, w + dt * alpha);
                        let report = law
                            .step(dt, &task(dt * f64::from(k)), &now)
                            .expect("finite");
                        errors.push([report.error.x, report.error.y, report.error.theta]);
                    }
                    errors
                };
                // The difference of two runs: what held torques leave of a curve falls out.
                let (one, other) = (run(1.0e-3), run(-1.0e-3));
                let size = |k: usize| {
                    // Over a window longer than a mode's period.
                    (k..k + 4_000)
                        .map(|k| {
                            (0..3)
                                .map(|i| (one[k][i] - other[k][i]).powi(2))
                                .sum::<f64>()
                        })
                        .sum::<f64>()
                        .sqrt()
                };
                let (decay, _) = slowest(&linearised(
                    &params.gains,
                    (twist.linear, twist.angular),
                    1.0,
                ));
                // After nine time constants of the slowest mode the others are gone, and after fourteen rounding is not near yet.
                let after = |constants: f64| (constants / decay / dt) as usize;
                let found = (size(after(9.0)) / size(after(14.0))).ln() / 5.0 * decay;
                println!(
                    "{} at {twist:?}: {found:.3}/s, the map {decay:.3}",
                    base.name
                );
                assert!(
                    (found - decay).abs() < 0.1 * decay + 0.02,
                    "{found} {decay}"
                );
            }
        }
    }

    #[test]
    fn the_built_in_bases_are_stable_and_lose_no_start() {
        for base in bases() {
            let map = StabilityMap::of(&base, 60, 1);
            println!("{}\n{map}", base.name);
            assert!(map.places.iter().all(|place| place.decay.1 > 0.0));
            assert_eq!(map.lost.failed, 0);
        }
    }
}
