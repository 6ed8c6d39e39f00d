//! What pushes the robot beside its wheels: friction, a slope, a push.

use super::load::{Driven, Load, LoadAxis, Window};
use super::params::ValidMotionParams;
use crate::range::clamp;
use crate::robot::{acceleration, wrench_for};
use crate::scalar::Scalar;
use crate::types::{Accel, Twist, Wrench};

/// Estimate of a disturbance, and what it needs to go on beside what the wheels exert.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Observer<T> {
    pub(crate) estimate: Wrench<T>,
    twist: Twist<T>,
    driving: LoadAxis<T>,
    turning: LoadAxis<T>,
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
    /// Nothing seen yet.
    pub(crate) const NEW: Self = Self {
        estimate: Wrench {
            force: T::ZERO,
            moment: T::ZERO,
        },
        twist: Twist::new(T::ZERO, T::ZERO),
        driving: LoadAxis::NEW,
        turning: LoadAxis::NEW,
    };

    /// From a robot that nobody has pushed yet.
    pub(crate) fn start(twist: &Twist<T>) -> Self {
        Self {
            twist: *twist,
            ..Self::NEW
        }
    }

    /// What the robot is found to carry.
    pub(crate) fn load(&self) -> Load<T> {
        Load {
            mass: self.driving.share,
            inertia: self.turning.share,
        }
    }

    pub(crate) fn residue(&self) -> T {
        self.driving.residue() + self.turning.residue()
    }

    /// The estimate after a tick of `dt`, and whether it stands at its bound.
    ///
    /// Frozen over a tick in which it is not known what the wheels `exerted`. `command_rate` is that of
    /// the tick before, which those wheels followed; see [`patient`].
    pub(crate) fn advance(
        &mut self,
        motion: &ValidMotionParams<T>,
        twist: &Twist<T>,
        command_rate: &Accel<T>,
        watch: Watch,
        exerted: Option<&Wrench<T>>,
        dt: T,
    ) -> bool {
        let moved = twist.minus(&self.twist);
        self.twist = *twist;
        let bandwidth = motion.gains().disturbance;
        let bound = &motion.disturbance;
        let gain = bandwidth / (T::ONE + bandwidth * dt);
        let last = self.estimate;
        let exerted = match (watch, exerted) {
            (Watch::Observe, Some(exerted)) => exerted,
            (watch, _) => {
                self.driving.skip();
                self.turning.skip();
                if watch == Watch::Fade {
                    self.estimate = Wrench {
                        force: last.force - gain * dt * last.force,
                        moment: last.moment - gain * dt * last.moment,
                    };
                }
                return false;
            }
        };
        let (robot, limits) = (&motion.params().robot, &motion.observer);
        let window = Window::of(dt);
        let pushed = Wrench {
            force: exerted.force + last.force,
            moment: exerted.moment + last.moment,
        };
        let push = acceleration(robot, &pushed);
        self.driving.advance(
            &limits.driving,
            &Driven {
                moved: moved.linear,
                push: push.linear,
                window,
            },
        );
        self.turning.advance(
            &limits.turning,
            &Driven {
                moved: moved.angular,
                push: push.angular,
                window,
            },
        );
        // M Δv of the loaded robot.
        let loaded = self.load().compensated(&Accel {
            linear: moved.linear,
            angular: moved.angular,
        });
        let gained = wrench_for(robot, &loaded);
        let force = estimate(
            last.force,
            gained.force,
            exerted.force,
            bound.force,
            (gain, dt),
        );
        let moment = estimate(
            last.moment,
            gained.moment,
            exerted.moment,
            bound.moment,
            (gain, dt),
        );
        self.estimate = Wrench {
            force: patient(last.force, force.0, command_rate.linear, limits.calm.linear),
            moment: patient(
                last.moment,
                moment.0,
                command_rate.angular,
                limits.calm.angular,
            ),
        };
        force.1 || moment.1
    }
}

/// The estimate `next`, slower where it says that the robot speeds up, or brakes, too easily.
///
/// ```text
/// Δd ← Δd/(1 + (a/a₀)²)       if Δd and d have the sign of a
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | Δd | `next` − `last` | N, N m |
/// | a | `rate` of the command | m/s², rad/s² |
/// | a₀ | `calm` | m/s², rad/s² |
///
/// A robot lighter than stated looks like that, for as long as it accelerates: the estimate would
/// make up for it, and push a robot of half the mass 4 mm past its goal with what it has not unlearnt
/// when braking ends. What is heavier, or rubs, gains from being learnt at once. A push of this sign
/// is learnt before and after. Only ever slower: the bound on the rate holds.
fn patient<T: Scalar>(last: T, next: T, rate: T, calm: T) -> T {
    let step = next - last;
    if step * rate > T::ZERO && next * rate > T::ZERO {
        let ratio = rate / calm;
        last + step / (T::ONE + ratio * ratio)
    } else {
        next
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
    if next.abs() <= bound {
        (next, false)
    } else {
        (clamp(next, bound), next.abs() > bound)
    }
}

#[cfg(test)]
mod tests {
    use super::{estimate, patient};

    /// Slower only where estimate, its change and the command's rate have one sign, and never further.
    #[test]
    fn patience_is_for_what_goes_too_easily() {
        for rate in [-1.0, 1.0] {
            assert_eq!(patient(2.0 * rate, 3.0 * rate, rate, 1.0), 2.5 * rate);
            // Unlearning, and learning what holds back.
            assert_eq!(patient(3.0 * rate, 2.0 * rate, rate, 1.0), 2.0 * rate);
            assert_eq!(patient(-2.0 * rate, -3.0 * rate, rate, 1.0), -3.0 * rate);
            // At rest everything is learnt.
            assert_eq!(patient(2.0 * rate, 3.0 * rate, 0.0, 1.0), 3.0 * rate);
        }
    }

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
