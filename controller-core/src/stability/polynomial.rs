//! Real polynomials of small degree: Routh's test, shifted and turned, and positive real roots.
//! Every operation has a fixed cost.

use crate::maths::Maths;
use crate::scalar::Scalar;

/// Room for the square of a loop of fifth order.
const SIZE: usize = 11;

/// Halvings of an interval: enough for every bit of the result's last 40.
const HALVINGS: u32 = 50;

/// c₀ + c₁ λ + … + c_n λⁿ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Polynomial<T> {
    /// Ascending; 0 beyond the degree.
    coefficients: [T; SIZE],
    degree: usize,
}

impl<T: Scalar> Polynomial<T> {
    /// From ascending coefficients, the last of them not 0.
    pub(crate) fn new<const N: usize>(ascending: [T; N]) -> Self {
        const { assert!(N > 0 && N <= SIZE) };
        Self {
            coefficients: core::array::from_fn(|k| item(&ascending, k)),
            degree: N - 1,
        }
    }

    pub(crate) fn coefficient(&self, power: usize) -> T {
        item(&self.coefficients, power)
    }

    pub(crate) fn degree(&self) -> usize {
        self.degree
    }

    pub(crate) fn leading(&self) -> T {
        self.coefficient(self.degree)
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            coefficients: core::array::from_fn(|k| self.coefficient(k) + other.coefficient(k)),
            degree: if self.degree > other.degree {
                self.degree
            } else {
                other.degree
            },
        }
    }

    pub(crate) fn scaled(&self, factor: T) -> Self {
        Self {
            coefficients: core::array::from_fn(|k| factor * self.coefficient(k)),
            degree: self.degree,
        }
    }

    /// The product; degrees add up to at most 10.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let product = |k: usize| {
            (0..=k).fold(T::ZERO, |sum, i| {
                sum + self.coefficient(i) * other.coefficient(k - i)
            })
        };
        Self {
            coefficients: core::array::from_fn(product),
            degree: self.degree + other.degree,
        }
    }

    /// In units of time in which a rate of `rate` is 1.
    pub(crate) fn in_units_of(&self, rate: T) -> Self {
        let mut power = T::ONE;
        let mut coefficients = self.coefficients;
        // Not beyond the degree, where a power that is no number would make one of 0.
        for coefficient in coefficients.iter_mut().take(self.degree + 1) {
            *coefficient = *coefficient * power;
            power = power * rate;
        }
        Self {
            coefficients,
            degree: self.degree,
        }
    }

    pub(crate) fn value(&self, at: T) -> T {
        let descending = self.coefficients.iter().rev();
        descending.fold(T::ZERO, |sum, c| sum * at + *c)
    }

    /// Real and imaginary part at a complex number.
    pub(crate) fn value_at(&self, (re, im): (T, T)) -> (T, T) {
        let descending = self.coefficients.iter().rev();
        descending.fold((T::ZERO, T::ZERO), |(x, y), c| {
            (x * re - y * im + *c, x * im + y * re)
        })
    }

    /// All roots have negative real parts: Routh's table, one row a step.
    ///
    /// Two rows of the table stand interleaved in one list p; the next two are
    /// q_j = p_(j+1), less p₀/p₁ · p_(j+2) for odd j.
    pub(crate) fn is_hurwitz(&self) -> bool {
        let sign = if self.leading() < T::ZERO {
            -T::ONE
        } else {
            T::ONE
        };
        let mut rows: [T; SIZE] = core::array::from_fn(|j| {
            let power = self.degree.checked_sub(j);
            sign * power.map_or(T::ZERO, |power| self.coefficient(power))
        });
        for _ in 0..self.degree {
            let (first, second) = (item(&rows, 0), item(&rows, 1));
            // So written that NaN fails.
            if !(first > T::ZERO && second > T::ZERO) {
                return false;
            }
            let ratio = first / second;
            rows = core::array::from_fn(|j| {
                let below = if j % 2 == 1 {
                    ratio * item(&rows, j + 2)
                } else {
                    T::ZERO
                };
                item(&rows, j + 1) - below
            });
        }
        item(&rows, 0) > T::ZERO
    }

    /// p(λ − σ): its roots are those of p, moved right by σ.
    pub(crate) fn shifted(&self, sigma: T) -> Self {
        let descending = self.coefficients.iter().rev();
        let coefficients = descending.fold([T::ZERO; SIZE], |q, c| {
            core::array::from_fn(|j| {
                let moved = j.checked_sub(1).map_or(*c, |below| item(&q, below));
                moved - sigma * item(&q, j)
            })
        });
        Self {
            coefficients,
            degree: self.degree,
        }
    }

    /// p(λ e^(jφ)) p(λ e^(−jφ)), real again: Hurwitz if and only if every root of p is more than φ
    /// to the left of the imaginary axis, that is, has a damping ratio of more than sin φ.
    pub(crate) fn turned(&self, (sine, cosine): (T, T)) -> Self {
        let (mut re, mut im) = (*self, *self);
        let (mut x, mut y) = (T::ONE, T::ZERO);
        for (re, im) in re.coefficients.iter_mut().zip(&mut im.coefficients) {
            *re = *re * x;
            *im = *im * y;
            (x, y) = (x * cosine - y * sine, x * sine + y * cosine);
        }
        re.times(&re).plus(&im.times(&im))
    }

    /// |p(jω)|² as a polynomial in x = ω².
    pub(crate) fn squared_magnitude(&self) -> Self {
        let mirrored = Self {
            coefficients: core::array::from_fn(|k| odd_sign(k, self.coefficient(k))),
            degree: self.degree,
        };
        let product = self.times(&mirrored);
        Self {
            coefficients: core::array::from_fn(|k| odd_sign(k, product.coefficient(2 * k))),
            degree: self.degree,
        }
    }

    /// Real roots between 0 and the bound of all roots at which p changes sign; what is left of the
    /// list is that bound. Each derivative's roots separate those of the one before.
    pub(crate) fn positive_roots(&self) -> (impl Iterator<Item = T>, T) {
        let largest = self.coefficients.iter().fold(T::ZERO, |largest, c| {
            let size = (*c / self.leading()).abs();
            if size > largest { size } else { largest }
        });
        let bound = T::ONE + largest;
        let mut splits = [bound; SIZE];
        for order in (0..self.degree).rev() {
            let p = (0..order).fold(*self, |p, _| p.derivative());
            let mut found = [bound; SIZE];
            let mut slots = found.iter_mut();
            let mut low = T::ZERO;
            for high in splits.iter().chain(core::iter::once(&bound)) {
                if (p.value(low) < T::ZERO) != (p.value(*high) < T::ZERO)
                    && let Some(slot) = slots.next()
                {
                    let rises = p.value(low) < T::ZERO;
                    *slot = edge(low, *high, |x| (p.value(x) < T::ZERO) == rises);
                }
                low = *high;
            }
            splits = found;
        }
        (splits.into_iter().filter(move |x| *x < bound), bound)
    }

    fn derivative(&self) -> Self {
        let mut power = T::ZERO;
        Self {
            coefficients: core::array::from_fn(|k| {
                power += T::ONE;
                power * self.coefficient(k + 1)
            }),
            degree: self.degree.saturating_sub(1),
        }
    }

    /// The smallest real part of −λ over all roots λ, negative if one grows; for a polynomial in
    /// units of time in which the mean of −λ is 1 ([`Polynomial::in_units_of`]).
    pub(crate) fn decay(&self) -> T {
        if self.is_hurwitz() {
            return edge(T::ZERO, T::ONE, |sigma| self.shifted(sigma).is_hurwitz());
        }
        let bound = self.coefficients.iter().fold(T::ONE, |bound, c| {
            let size = T::ONE + (*c / self.leading()).abs();
            if size > bound { size } else { bound }
        });
        -edge(T::ZERO, bound, |sigma| !self.shifted(-sigma).is_hurwitz())
    }

    /// The smallest damping ratio −Re λ/|λ| over all roots, 0 if one does not decay.
    pub(crate) fn damping<M: Maths<T>>(&self) -> T {
        let damped = |angle: T| self.turned(M::sin_cos(angle)).is_hurwitz();
        if !self.is_hurwitz() {
            return T::ZERO;
        }
        M::sin_cos(edge(T::ZERO, T::FRAC_PI_2, damped)).0
    }
}

/// Where `holds` ends between `low`, where it does, and `high`.
pub(crate) fn edge<T: Scalar>(mut low: T, mut high: T, mut holds: impl FnMut(T) -> bool) -> T {
    for _ in 0..HALVINGS {
        let middle = T::HALF * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

fn item<T: Scalar>(list: &[T], index: usize) -> T {
    list.get(index).copied().unwrap_or(T::ZERO)
}

fn odd_sign<T: Scalar>(power: usize, value: T) -> T {
    if power % 2 == 1 { -value } else { value }
}

#[cfg(test)]
mod tests;
