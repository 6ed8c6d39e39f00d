//! What pushes the robot beside its wheels: friction, a slope, a load, a mass that is not as stated.

use super::params::Motion;
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::types::{Twist, Wrench};

/// Estimate of a disturbance, and what it needs to go on: the last twist and what the wheels exert.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Observer<T> {
    pub(crate) estimate: Wrench<T>,
    twist: Twist<T>,
    /// What the wheels exert until the next tick; `None` if nobody knows, or they are not driven.
    exerted: Option<Wrench<T>>,
}

/// What an observer is to do in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Watch {
    /// Estimate.
    Observe,
    /// The robot is about to be let go: forget, so that the torque ends without a step.
    Fade,
}

impl<T: Scalar> Observer<T> {
    /// From a robot that nobody has pushed yet.
    pub(crate) fn start(twist: &Twist<T>) -> Self {
        Self {
            twist: *twist,
            ..Self::default()
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.estimate.force.is_finite() && self.estimate.moment.is_finite()
    }

    /// What the wheels will exert until the next tick.
    pub(crate) fn note(&mut self, exerted: Option<Wrench<T>>) {
        self.exerted = exerted;
    }

    /// The estimate after a tick of `dt`, and whether it stands at its bound.
    ///
    /// Frozen over a tick in which it is not known what the wheels exerted.
    pub(crate) fn advance(
        &mut self,
        motion: &Motion<T>,
        twist: &Twist<T>,
        watch: Watch,
        dt: T,
    ) -> bool {
        let moved = twist.minus(&self.twist);
        self.twist = *twist;
        let bandwidth = motion.gains().disturbance;
        let bound = &motion.disturbance;
        let gain = bandwidth / (T::ONE + bandwidth * dt);
        let last = self.estimate;
        match (watch, &self.exerted) {
            (Watch::Fade, _) => {
                self.estimate = Wrench {
                    force: last.force - gain * dt * last.force,
                    moment: last.moment - gain * dt * last.moment,
                };
                false
            }
            (Watch::Observe, None) => false,
            (Watch::Observe, Some(exerted)) => {
                let robot = &motion.params().robot;
                let force = estimate(
                    last.force,
                    robot.mass_kg * moved.linear,
                    exerted.force,
                    bound.force,
                    (gain, dt),
                );
                let moment = estimate(
                    last.moment,
                    robot.inertia_kg_m2 * moved.angular,
                    exerted.moment,
                    bound.moment,
                    (gain, dt),
                );
                self.estimate = Wrench {
                    force: force.0,
                    moment: moment.0,
                };
                force.1 || moment.1
            }
        }
    }
}

/// One axis of the observer, implicit in the estimate: stable for any ω dt.
///
/// ```text
/// d ← d + g clamp(Δp − dt (F + d), D dt),   g = ω/(1 + ω dt),   then |d| ≤ D
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | d | `last`: what acts beside the wheels | N, N m |
/// | Δp = m Δv, I Δw | `momentum`: gained in the tick | N s, N m s |
/// | F | `exerted` by the wheels in the tick | N, N m |
/// | D | `bound` | N, N m |
/// | g, dt | `(gain, dt)` | 1/s, s |
///
/// ḋ = ω (ṗ − F − d) over a tick. Nothing is divided by dt. The clamp of the innovation bounds the
/// rate to ω D; as d itself is the memory, cutting it at D leaves nothing wound up.
fn estimate<T: Scalar>(
    last: T,
    momentum: T,
    exerted: T,
    bound: T,
    (gain, dt): (T, T),
) -> (T, bool) {
    let innovation = clamp(momentum - dt * (exerted + last), bound * dt);
    let next = last + gain * innovation;
    (clamp(next, bound), next.abs() > bound)
}

#[cfg(test)]
mod tests {
    use super::estimate;

    /// A body of 30 kg under a force that nobody knows, with any ω dt: no overshoot, never faster than
    /// ω D, never beyond D.
    #[test]
    fn estimate_is_stable_for_any_tick() {
        for (push, bound) in [(30.0, 37.5), (-30.0, 37.5), (60.0, 37.5)] {
            for bandwidth in [0.0_f64, 0.1, 2.5, 50.0] {
                for dt in [1e-5, 1e-3, 1e-2, 0.5, 1e3] {
                    let gain = bandwidth / (1.0 + bandwidth * dt);
                    let (mut d, mut bounded) = (0.0_f64, false);
                    for _ in 0..50 {
                        let exerted = -3.0;
                        let momentum = dt * (exerted + push);
                        let last = d;
                        (d, bounded) = estimate(last, momentum, exerted, bound, (gain, dt));
                        // A rounding of the numbers summed, over the last one's.
                        assert!((d - last).abs() <= bandwidth * bound * dt * (1.0 + 1e-9));
                        assert!(d.abs() <= bound && d.abs() <= push.abs() * (1.0 + 1e-9));
                    }
                    if bandwidth * dt > 1.0 {
                        let all = push.clamp(-bound, bound);
                        assert!((d - all).abs() < 1e-9 * all.abs(), "{bandwidth} {dt}: {d}");
                        assert_eq!(bounded, push.abs() > bound);
                    }
                }
            }
        }
    }

    /// What was wound up at the bound is gone in the next tick.
    #[test]
    fn nothing_winds_up_at_the_bound() {
        let (mut d, dt, gain) = (0.0_f64, 0.01, 2.5 / 1.025);
        for _ in 0..10_000 {
            (d, _) = estimate(d, dt * 100.0, 0.0, 37.5, (gain, dt));
        }
        let (next, bounded) = estimate(d, 0.0, 0.0, 37.5, (gain, dt));
        assert!(next < d && !bounded);
    }
}
