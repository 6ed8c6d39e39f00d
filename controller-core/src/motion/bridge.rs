//! What the command still owes to the past: a jump of the wanted twist, fading.

use crate::scalar::Scalar;

/// Two neurons without input in cascade: b″ + 2 A b′ + A² b = 0.
///
/// Set at a jump so that wanted value and rate go on from those of the command; from then on both
/// fade together. `rate` is the exact rate of `value`: command and feed-forward agree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bridge<T> {
    pub(crate) value: T,
    pub(crate) rate: T,
}

impl<T: Scalar> Bridge<T> {
    pub(crate) fn is_finite(&self) -> bool {
        self.value.is_finite() && self.rate.is_finite()
    }

    /// The exact solution after `dt`, with `fade` = exp(−A dt): b ← (b + q dt) fade with
    /// q = b′ + A b, and b′ ← (q − A (b + q dt)) fade.
    pub(crate) fn advance(&self, decay: T, dt: T, fade: T) -> Self {
        let q = self.rate + decay * self.value;
        let moved = self.value + q * dt;
        Self {
            value: moved * fade,
            rate: (q - decay * moved) * fade,
        }
    }
}
