//! The gear: torque at the wheel and current in the motor.

use crate::range::signed;
use crate::scalar::Scalar;

/// A gear that loses a share 1 − η of the power that goes through it.
///
/// Power to the wheel, τω > 0, has to be made greater: τ = η g k_t i. Power from the wheel arrives
/// smaller, so the loss helps the brake: g k_t i = η τ. Hence i = τ/(η g k_t) driving and i = η τ/(g k_t)
/// braking. Both are zero at τ = 0, but at ω = 0 the current of a held torque would jump by a factor
/// of 1/η²: at a standstill it would chatter with the sign of a noisy speed. With the sense of motion σ
/// the two are one law,
///
/// ```text
/// i = (c_m τ + c_h σ |τ|)/(g k_t)      c_m = (1/η + η)/2      c_h = (1/η − η)/2
/// ```
///
/// that is: a lossless gear with c_m, and a Coulomb friction of c_h |τ|, as large as the load makes it.
/// Like any Coulomb friction it is blended by σ = sat(ω*/ω_b) of the desired speed. Continuous in τ and
/// σ; in τ it rises everywhere, with slopes from η to 1/η, because c_m − c_h = η > 0; odd in (τ, σ).
/// At rest the gear takes any torque between both laws, and σ = 0 the middle of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gear<T> {
    /// g k_t: lossless wheel torque per ampere, and volt per wheel speed.
    pub(super) constant: T,
    /// c_m/(g k_t).
    mean: T,
    /// c_h/(g k_t).
    half: T,
    /// η g k_t.
    driving: T,
}

impl<T: Scalar> Gear<T> {
    pub(super) fn new(constant: T, efficiency: T) -> Self {
        let (driving, braking) = (T::ONE / efficiency, efficiency);
        Self {
            constant,
            mean: T::HALF * (driving + braking) / constant,
            half: T::HALF * (driving - braking) / constant,
            driving: efficiency * constant,
        }
    }

    /// Current \[A\] for a wheel torque, for the sense of motion σ in [−1, 1].
    #[inline(always)]
    pub(super) fn current(&self, torque: T, sense: T) -> T {
        self.mean * torque + self.half * sense * torque.abs()
    }

    /// The inverse of [`current`](Self::current).
    #[inline(always)]
    pub(super) fn torque(&self, current: T, sense: T) -> T {
        // Current and torque have the same sign, for both slopes are positive.
        current / (self.mean + self.half * signed(sense, current))
    }

    /// Torque that a current exerts while the motor drives: the least of all.
    pub(super) fn driving_torque(&self, current: T) -> T {
        self.driving * current
    }
}
