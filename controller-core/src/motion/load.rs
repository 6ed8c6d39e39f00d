//! How much heavier than stated the robot is: a payload, or one that it lost.

use crate::cast::cast;
use crate::range::clamp;
use crate::scalar::{Scalar, residue};
use crate::types::Accel;

/// Largest load, either way, as a share of the stated mass and inertia. What is beyond is left to the disturbance estimate.
pub(super) const LARGEST: f64 = 0.4;

/// λ \[1/s\]: rate of the window in which torque and motion are compared. 0.2 s are five times what a speed estimate of 50 rad/s
/// lags by, and shorter than a base takes to reach its speed.
const WINDOW: f64 = 5.0;

/// T \[s\]: what is believed beforehand weighs as much as so long a time at the largest acceleration a, x = a/λ. In a step of
/// that acceleration x is a/λ (1 − e^(−λt)), and half of the load is known once λ² ∫x² dt/a² is T ln 2: after 0.16 s.
const BELIEF_S: f64 = 0.03;

/// Share of the largest x below which nothing is learnt: at a tenth of the largest acceleration friction that nobody knows, up to
/// the eighth of the largest force that is compensated, says more than the mass does.
const TELLING: f64 = 0.1;

/// Load, as shares of the stated mass and inertia: 0.3 is 30 % more. Within ±0.4.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load<T = f32> {
    /// Of the mass.
    pub mass: T,
    /// Of the inertia.
    pub inertia: T,
}

cast!(Load { mass, inertia });

impl<T: Scalar> Load<T> {
    /// What has to be fed forward to the stated mass and inertia, so that the loaded robot is accelerated by `rate`.
    pub(super) fn compensated(&self, rate: &Accel<T>) -> Accel<T> {
        Accel {
            linear: rate.linear + self.mass * rate.linear,
            angular: rate.angular + self.inertia * rate.angular,
        }
    }

    /// The acceleration of the loaded robot by what gives the stated one `accel`.
    pub(crate) fn slowed(&self, accel: &Accel<T>) -> Accel<T> {
        Accel {
            linear: accel.linear / (T::ONE + self.mass),
            angular: accel.angular / (T::ONE + self.inertia),
        }
    }
}

/// One axis of the estimate. With M the stated mass or inertia and d what acts beside the wheels, M (1 + σ) v̇ = F + d; both
/// sides pass the same filter, so that speeds need not be differentiated:
///
/// ```text
/// x = s/(s + λ) v                    gained in the window
/// y = 1/(s + λ) (F + d̂)/M − x        missing of what should have been gained:  y = σ x − 1/(s + λ) (d − d̂)/M
/// σ ← σ + sat(dt x′ (y − σ x)/(s₀ + dt x′ x)),   x′ = x − sat(x, a/(10 λ)),   s₀ = T (a/λ)²,   |σ| ≤ σ_max
/// ```
///
/// | symbol | what | unit |
/// | --- | --- | --- |
/// | v | speed or turn rate, measured | m/s, rad/s |
/// | F, d̂ | force or moment of the wheels; estimated disturbance | N, N m |
/// | σ | load, as a share of M | |
/// | a, j | largest acceleration and jerk | m/s², m/s³ |
///
/// The least squares of y = σ x with a memory of s₀, implicit in σ: stable for any tick. At rest, at constant speed and
/// while it creeps x′ is zero and nothing is learnt. A push that d̂ does not have yet looks like a load while the robot accelerates, and as one of
/// the other sign while it brakes; either way the torque is the right one. `sat` bounds the rate to σ_max j/a, so that
/// σ times the largest acceleration changes no faster than σ_max times the largest jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LoadAxis<T> {
    gained: T,
    missing: T,
    pub(super) share: T,
}

/// What follows from the limits of an axis, a and j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadLimits<T> {
    /// a/(10 λ).
    idle: T,
    /// s₀.
    belief: T,
    /// Largest rate of σ \[1/s\].
    rate: T,
}

impl<T: Scalar> LoadLimits<T> {
    pub(super) fn of(accel: T, jerk: T) -> Self {
        let f = T::from_f64;
        let largest = accel / f(WINDOW);
        Self {
            idle: f(TELLING) * largest,
            belief: f(BELIEF_S) * largest * largest,
            rate: f(LARGEST) * jerk / accel,
        }
    }
}

/// What an axis is driven by for a tick.
pub(super) struct Driven<T> {
    /// Change of the speed \[m/s, rad/s\].
    pub(super) moved: T,
    /// (F + d̂)/M \[m/s², rad/s²\].
    pub(super) push: T,
    /// Of the tick, as of [`Window::of`].
    pub(super) window: Window<T>,
}

/// A tick of the window.
#[derive(Clone, Copy)]
pub(super) struct Window<T> {
    dt: T,
    /// 1/(1 + λ dt).
    shrink: T,
}

impl<T: Scalar> Window<T> {
    pub(super) fn of(dt: T) -> Self {
        let shrink = T::ONE / (T::ONE + T::from_f64(WINDOW) * dt);
        Self { dt, shrink }
    }
}

impl<T: Scalar> LoadAxis<T> {
    /// The robot as stated.
    pub(super) const NEW: Self = Self {
        gained: T::ZERO,
        missing: T::ZERO,
        share: T::ZERO,
    };

    pub(super) fn advance(&mut self, limits: &LoadLimits<T>, now: &Driven<T>) {
        let Window { dt, shrink } = now.window;
        self.gained = (self.gained + now.moved) * shrink;
        self.missing = (self.missing + dt * now.push - now.moved) * shrink;
        let x = self.gained;
        if x.abs() <= limits.idle {
            return;
        }
        let beyond = if x > T::ZERO {
            x - limits.idle
        } else {
            x + limits.idle
        };
        let weight = dt * beyond;
        // The quotient first: what overflows at speeds that no robot has does so in its denominator.
        let gain = weight / (limits.belief + weight * x);
        let change = gain * (self.missing - self.share * x);
        let change = clamp(change, limits.rate * dt);
        self.share = clamp(self.share + change, T::from_f64(LARGEST));
    }

    /// Nobody knows what drove the robot: the window begins anew.
    pub(super) fn skip(&mut self) {
        (self.gained, self.missing) = (T::ZERO, T::ZERO);
    }

    pub(super) fn residue(&self) -> T {
        residue([self.gained, self.missing])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body of (1 + `load`) M whose speed goes up to a and down again with `push` beside the torque: the estimate at its end.
    fn learnt(load: f64, push: f64, dt: f64) -> f64 {
        let accel = 6.0;
        let mut axis = LoadAxis::NEW;
        let ticks = (1.0 / dt) as i32;
        for tick in 0..ticks {
            let rate = accel * (core::f64::consts::TAU * f64::from(tick) / f64::from(ticks)).sin();
            let now = Driven {
                moved: rate * dt,
                push: (1.0 + load) * rate - push,
                window: Window::of(dt),
            };
            axis.advance(&LoadLimits::of(accel, 80.0), &now);
            assert!(axis.share.abs() <= LARGEST);
        }
        axis.share
    }

    /// Within a hundredth after a second, up to the bound and no further.
    #[test]
    fn a_load_is_learnt() {
        for dt in [0.001, 0.01, 0.05] {
            for load in [-0.3, 0.0, 0.2, 0.39] {
                assert!((learnt(load, 0.0, dt) - load).abs() < 0.01, "{load} {dt}");
            }
            assert_eq!(learnt(1.0, 0.0, dt), LARGEST);
            assert_eq!(learnt(-0.8, 0.0, dt), -LARGEST);
        }
    }

    /// At rest under any torque nothing is learnt: what holds the robot is no load.
    #[test]
    fn rest_tells_nothing() {
        let mut axis = LoadAxis::NEW;
        for _ in 0..1000 {
            let now = Driven {
                moved: 0.0,
                push: 3.0,
                window: Window::of(0.01),
            };
            axis.advance(&LoadLimits::of(6.0, 80.0), &now);
        }
        assert_eq!(axis.share, 0.0);
    }

    /// With any tick the estimate goes towards the load and not beyond it.
    #[test]
    fn any_tick_is_stable() {
        for dt in [1e-5, 1e-3, 0.1, 1.0, 1e3] {
            let mut axis = LoadAxis::NEW;
            let mut last = 0.0;
            for _ in 0..200 {
                let now = Driven {
                    moved: 6.0 * dt,
                    push: 1.2 * 6.0,
                    window: Window::of(dt),
                };
                axis.advance(&LoadLimits::of(6.0, 80.0), &now);
                // y settles with x: never beyond the load but for rounding.
                assert!(
                    axis.share >= last - 1e-12 && axis.share <= 0.2 + 1e-12,
                    "{dt}: {}",
                    axis.share
                );
                last = axis.share;
            }
        }
    }
}
