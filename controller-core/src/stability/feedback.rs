//! One feedback loop by its characteristic polynomial, and how far it is from growing.

use super::polynomial::{Polynomial, edge};
use crate::maths::Maths;
use crate::scalar::Scalar;

/// Largest factor that is looked for; a margin of this size means "at least".
pub const LARGEST_FACTOR: f64 = 1000.0;

/// How far a loop is from growing oscillation. All 0 or below if it grows as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargins<T> {
    /// Smallest rate at which anything decays \[1/s\]: the negated spectral abscissa. Below 0 it grows.
    pub decay: T,
    /// Damping ratio of the least damped pair of roots: 1 for no oscillation, 0.4 for 25 % overshoot.
    pub damping: T,
    /// Largest age of the pose that the loop survives \[s\].
    pub pose_delay_s: T,
    /// Largest delay of the torque that the loop survives \[s\]: half a tick, drives, bus.
    pub torque_delay_s: T,
    /// Largest factor on all pose feedback, at most [`LARGEST_FACTOR`].
    pub gain: T,
    /// Largest factor of the true mass (or inertia) over the believed one, at most [`LARGEST_FACTOR`].
    pub heavier: T,
}

impl<T: Scalar> LoopMargins<T> {
    /// The worse of both, field by field.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        let less = |a: T, b: T| if a < b { a } else { b };
        Self {
            decay: less(self.decay, other.decay),
            damping: less(self.damping, other.damping),
            pose_delay_s: less(self.pose_delay_s, other.pose_delay_s),
            torque_delay_s: less(self.torque_delay_s, other.torque_delay_s),
            gain: less(self.gain, other.gain),
            heavier: less(self.heavier, other.heavier),
        }
    }

    /// Nothing grows.
    pub fn is_stable(&self) -> bool {
        self.decay > T::ZERO
    }
}

/// The characteristic polynomial μ `mass` + `rest` + g `pose`, with μ = g = 1: what the true over
/// the believed mass multiplies, what depends on neither, and what the measured pose passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Feedback<T> {
    pub(crate) mass: Polynomial<T>,
    pub(crate) rest: Polynomial<T>,
    pub(crate) pose: Polynomial<T>,
}

impl<T: Scalar> Feedback<T> {
    pub(crate) fn characteristic(&self) -> Polynomial<T> {
        self.mass.plus(&self.rest).plus(&self.pose)
    }

    pub(crate) fn is_stable(&self) -> bool {
        self.characteristic().is_hurwitz()
    }

    /// All margins. A late pose multiplies `pose` by e^(−λd), a late torque all but `mass`.
    pub(crate) fn margins<M: Maths<T>>(&self) -> LoopMargins<T> {
        // In units of time in which the roots' mean is 1, so that nothing overflows or drowns.
        let whole = self.characteristic();
        let order = whole.degree();
        let mean = (0..order).fold(T::ZERO, |sum, _| sum + T::ONE);
        let rate = whole.coefficient(order.saturating_sub(1)) / (mean * whole.leading());
        let leading = T::ONE / whole.in_units_of(rate).leading();
        let unit = |p: &Polynomial<T>| p.in_units_of(rate).scaled(leading);
        let (mass, rest, pose) = (unit(&self.mass), unit(&self.rest), unit(&self.pose));
        let whole = mass.plus(&rest).plus(&pose);
        let decay = rate * whole.decay();
        if !whole.is_hurwitz() {
            return LoopMargins {
                decay,
                damping: T::ZERO,
                pose_delay_s: T::ZERO,
                torque_delay_s: T::ZERO,
                gain: T::ZERO,
                heavier: T::ZERO,
            };
        }
        let late_pose = smallest_delay::<T, M>(&mass.plus(&rest), &pose);
        let late_torque = smallest_delay::<T, M>(&mass, &rest.plus(&pose));
        let fixed = rest.plus(&mass);
        let others = rest.plus(&pose);
        LoopMargins {
            decay,
            damping: whole.damping::<M>(),
            pose_delay_s: late_pose / rate,
            torque_delay_s: late_torque / rate,
            gain: largest_factor(|g| fixed.plus(&pose.scaled(g)).is_hurwitz()),
            heavier: largest_factor(|mu| others.plus(&mass.scaled(mu)).is_hurwitz()),
        }
    }
}

/// The smallest d > 0 for which D + N e^(−λd) has a root on the imaginary axis, for a loop that is
/// stable without: at every ω with |D| = |N|, d = arg(−N/D)/ω. `T::MAX` if there is none.
fn smallest_delay<T: Scalar, M: Maths<T>>(d: &Polynomial<T>, n: &Polynomial<T>) -> T {
    let gap = d
        .squared_magnitude()
        .plus(&n.squared_magnitude().scaled(-T::ONE));
    let (crossings, _) = gap.positive_roots();
    crossings.fold(T::MAX, |smallest, x| {
        let frequency = M::sqrt(x);
        let (dr, di) = d.value_at((T::ZERO, frequency));
        let (nr, ni) = n.value_at((T::ZERO, frequency));
        // −N times the conjugate of D.
        let angle = M::atan2(nr * di - ni * dr, -(nr * dr + ni * di));
        let angle = if angle > T::ZERO {
            angle
        } else {
            angle + T::PI + T::PI
        };
        let delay = angle / frequency;
        if delay < smallest { delay } else { smallest }
    })
}

/// The first factor above 1 at which `stable` ends, by doubling and halving.
fn largest_factor<T: Scalar>(stable: impl Fn(T) -> bool) -> T {
    let largest = T::from_f64(LARGEST_FACTOR);
    let mut low = T::ONE;
    // 2^10 is beyond the largest.
    for _ in 0..10 {
        let double = low + low;
        let high = if double < largest { double } else { largest };
        if !stable(high) {
            return edge(low, high, &stable);
        }
        low = high;
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::{Libm, Single};

    /// λ + k with a late pose: an integrator with gain k survives π/(2k).
    fn integrator<T: Scalar>(k: T) -> Feedback<T> {
        Feedback {
            mass: Polynomial::new([T::ZERO, T::ONE]),
            rest: Polynomial::new([T::ZERO]),
            pose: Polynomial::new([k]),
        }
    }

    #[test]
    fn integrator_survives_a_quarter_turn_of_delay() {
        let margins = integrator(2.0_f64).margins::<Libm>();
        let expected = core::f64::consts::FRAC_PI_4;
        // Bisection to the last bits, and a square root.
        assert!((margins.pose_delay_s - expected).abs() < 1e-9);
        assert!((margins.torque_delay_s - expected).abs() < 1e-9);
        assert!((margins.decay - 2.0).abs() < 1e-9);
        assert_eq!(margins.gain, LARGEST_FACTOR);
        let single = integrator(2.0_f32).margins::<Single>();
        assert!((single.pose_delay_s.to_f64() - expected).abs() < 1e-5);
    }

    /// λ² + λ + 1: an inertia with damping and a spring. Where |λ² + λ| = 1, at ω² = (√5 − 1)/2, 51.8° are left for a late pose, and where
    /// |λ²| = |λ + 1|, at ω² = (√5 + 1)/2, the same for a late torque.
    #[test]
    fn a_damped_spring_has_the_margins_of_the_golden_ratio() {
        let golden = 0.5 * (1.0 + Libm::sqrt(5.0_f64));
        let root = Libm::sqrt(golden);
        let left = Libm::atan2(root, 1.0);
        // Faster by a factor, and heavier: the margins are those of the same loop on another clock.
        for (rate, inertia) in [(1.0, 1.0), (40.0, 1.0), (0.02, 7.0)] {
            let of_rate = Feedback {
                mass: Polynomial::new([0.0, 0.0, inertia]),
                rest: Polynomial::new([0.0, inertia * rate]),
                pose: Polynomial::new([inertia * rate * rate]),
            };
            let margins = of_rate.margins::<Libm>();
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
            assert!(
                near(margins.pose_delay_s * rate, left * root),
                "{margins:?}"
            );
            assert!(near(margins.torque_delay_s * rate, left / root));
            assert!(near(margins.decay / rate, 0.5) && near(margins.damping, 0.5));
            assert!(margins.is_stable() && of_rate.is_stable());
            assert_eq!(
                (margins.gain, margins.heavier),
                (LARGEST_FACTOR, LARGEST_FACTOR)
            );
        }
    }

    /// λ² + λ/5 + 1 with a pose that pushes by half: |D| = ½ at ω² = (1.96 ± √0.8416)/2, where −N/D looks back by arg D. So a late pose
    /// has the rest of a whole turn left, the least at the upper frequency.
    #[test]
    fn what_leads_is_late_by_the_rest_of_a_turn() {
        let pushed = Feedback {
            mass: Polynomial::new([0.0, 0.0, 1.0]),
            rest: Polynomial::new([1.0, 0.2]),
            pose: Polynomial::new([-0.5]),
        };
        let square = 0.5 * (1.96 + Libm::sqrt(0.8416_f64));
        let frequency = Libm::sqrt(square);
        let behind = Libm::atan2(0.2 * frequency, 1.0 - square);
        let expected = (core::f64::consts::TAU - behind) / frequency;
        let margins = pushed.margins::<Libm>();
        assert!((margins.pose_delay_s / expected - 1.0).abs() < 1e-9);
    }

    /// A loop whose coefficients are within single precision, and their squares beyond it: its margins are finite all the same.
    #[test]
    fn margins_of_extreme_rates_do_not_overflow() {
        for rate in [1.0e7_f32, 1.0e-7] {
            let loop_of = Feedback {
                mass: Polynomial::new([0.0, 0.0, 0.0, 1.0]),
                rest: Polynomial::new([0.0, 2.0 * rate * rate, 2.0 * rate]),
                pose: Polynomial::new([rate * rate * rate]),
            };
            let margins = loop_of.margins::<Single>();
            assert!((margins.heavier - 4.0).abs() < 1e-4, "{margins:?}");
            // (λ + 1)(λ² + λ + 1).
            assert!((margins.decay / rate - 0.5).abs() < 1e-4, "{margins:?}");
            assert!(margins.pose_delay_s * rate > 0.5 && margins.torque_delay_s * rate > 0.5);
        }
    }

    /// The first end counts, not a later one, and what lies below the largest factor by less than a doubling is found.
    #[test]
    fn factor_is_the_first_at_which_a_loop_grows() {
        for end in [3.0, 700.0] {
            let factor = largest_factor(|x: f64| x < end || x > 1.5 * end);
            assert!((factor - end).abs() < 1e-9, "{factor}");
        }
        assert_eq!(largest_factor(|x: f64| x < 1001.0), LARGEST_FACTOR);
    }

    /// μ λ³ + 2 λ² + 2 λ + g grows from μ g = 4 on.
    #[test]
    fn a_lagging_loop_grows_when_it_is_four_times_as_heavy() {
        let feedback = |mu: f64| Feedback {
            mass: Polynomial::new([0.0, 0.0, 0.0, mu]),
            rest: Polynomial::new([0.0, 2.0, 2.0]),
            pose: Polynomial::new([1.0]),
        };
        let margins = feedback(1.0).margins::<Libm>();
        assert!((margins.heavier - 4.0).abs() < 1e-9 && (margins.gain - 4.0).abs() < 1e-9);
        assert!(feedback(3.99).is_stable() && !feedback(4.01).is_stable());
        // Each field of two is the worse one's, and a loop that does not decay is not stable.
        let heavy = feedback(2.0).margins::<Libm>();
        let (one, other) = (margins.worse(&heavy), heavy.worse(&margins));
        assert_eq!((one, other), (heavy, heavy));
        let still = LoopMargins {
            decay: 0.0,
            ..heavy
        };
        assert!(!still.is_stable() && heavy.is_stable());
    }

    #[test]
    fn gain_margin_of_three_equal_lags_is_eight() {
        // (λ + 1)³ + g: stable up to g = 8, and then grows.
        let lag = Polynomial::new([1.0, 1.0]);
        let feedback = |g: f64| Feedback {
            mass: lag.times(&lag).times(&lag),
            rest: Polynomial::new([0.0]),
            pose: Polynomial::new([g]),
        };
        assert!((feedback(0.5).margins::<Libm>().gain - 16.0).abs() < 1e-6);
        let lost = feedback(9.0).margins::<Libm>();
        assert!(lost.decay < 0.0 && lost.gain == 0.0 && !lost.is_stable());
    }
}
