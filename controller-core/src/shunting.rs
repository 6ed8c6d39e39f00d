//! The shunting neuron: a leaky integrator whose state cannot leave [−D, B]. Eqs. (4) and (5).

use crate::error::{Field, ParamError};
use crate::maths::Maths;
use crate::params::NeuronParams;
use crate::range::within;
use crate::scalar::Scalar;

/// Excitatory input. Eq. (5): S⁺(u) = max(0, u).
#[inline]
pub fn excitatory<T: Scalar>(input: T) -> T {
    if input > T::ZERO { input } else { T::ZERO }
}

/// Inhibitory input. Eq. (5): S⁻(u) = max(0, −u).
#[inline]
pub fn inhibitory<T: Scalar>(input: T) -> T {
    if input < T::ZERO { -input } else { T::ZERO }
}

/// How a neuron is advanced over a tick, chosen by type. The input is known only at the two ends.
pub trait NeuronUpdate<T: Scalar>:
    Copy + core::fmt::Debug + Default + Send + Sync + 'static
{
    /// The input that is taken to hold over a tick, from its values at both ends.
    fn drive(before: T, now: T) -> T;
    /// Share of the way to equilibrium that a tick covers: 1 − exp(−a) or an approximation, in
    /// [0, 1] for every `a` ≥ 0. `a` is the tick times the decay rate.
    fn share<M: Maths<T>>(a: T) -> T;
}

/// Exact exponential, input held from the last tick: the textbook sampled neuron.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactHeld;

/// Exact exponential of the mean of the last input and the present one.
///
/// Second order for a smooth input where [`ExactHeld`] is first order: at 10 ms its error for
/// u = 2 sin 3t is a hundred times smaller. Causal, since the controller measures first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactMean;

/// Mean of inputs, exponential replaced by its [0/4] Padé form: no library call on the chip.
///
/// With h = 1 + a/2 + a²/6 + a³/24, share = a h/(1 + a h) is 1 − 1/(1 + a + … + a⁴/24): positive,
/// below 1 for every a, so the bound on the state holds for every tick. Relative error of the
/// share: 7e-7 at a = 0.1, 2e-3 at a = 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RationalMean;

impl<T: Scalar> NeuronUpdate<T> for ExactHeld {
    #[inline]
    fn drive(before: T, _now: T) -> T {
        before
    }
    #[inline]
    fn share<M: Maths<T>>(a: T) -> T {
        exact_share::<T, M>(a)
    }
}

impl<T: Scalar> NeuronUpdate<T> for ExactMean {
    #[inline]
    fn drive(before: T, now: T) -> T {
        // Halves first: the sum of two large inputs must not overflow.
        T::HALF * before + T::HALF * now
    }
    #[inline]
    fn share<M: Maths<T>>(a: T) -> T {
        exact_share::<T, M>(a)
    }
}

impl<T: Scalar> NeuronUpdate<T> for RationalMean {
    #[inline]
    fn drive(before: T, now: T) -> T {
        T::HALF * before + T::HALF * now
    }
    #[inline]
    fn share<M: Maths<T>>(a: T) -> T {
        let sixth = T::from_f64(1.0 / 6.0);
        let quarter_of_sixth = T::from_f64(1.0 / 24.0);
        let ah = a * (T::ONE + a * (T::HALF + a * (sixth + a * quarter_of_sixth)));
        ah / (T::ONE + ah)
    }
}

#[inline]
fn exact_share<T: Scalar, M: Maths<T>>(a: T) -> T {
    let share = -M::exp_m1(-a);
    // A back end may be off by its last bit; the share is a share.
    if share > T::ONE { T::ONE } else { share }
}

/// Coefficients A, B, D of Eq. (4), each in [1e-3, 1e4].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shunting<T> {
    decay: T,
    upper: T,
    lower: T,
}

impl<T: Scalar> Shunting<T> {
    /// Beyond this many time constants a tick is a full step to equilibrium to within 3e-15; the
    /// cap keeps a⁴ finite in single precision.
    const LONGEST: f64 = 1.0e4;

    /// Checks A, B and D.
    ///
    /// # Errors
    /// The first coefficient out of [1e-3, 1e4]. The range leaves the products of a tick finite.
    pub fn new(params: &NeuronParams<T>) -> Result<Self, ParamError> {
        Ok(Self {
            decay: within(Field::DecayA, params.a, 1.0e-3, 1.0e4)?,
            upper: within(Field::UpperB, params.b, 1.0e-3, 1.0e4)?,
            lower: within(Field::LowerD, params.d, 1.0e-3, 1.0e4)?,
        })
    }

    /// A \[1/s\].
    pub fn decay(&self) -> T {
        self.decay
    }

    /// B, the upper bound of the state.
    pub fn upper(&self) -> T {
        self.upper
    }

    /// −D, the lower bound of the state.
    pub fn lower(&self) -> T {
        -self.lower
    }

    /// `state` is in [−D, B].
    pub fn contains(&self, state: T) -> bool {
        state >= -self.lower && state <= self.upper
    }

    /// The state in [−D, B] nearest to `state`, which may be infinite.
    pub(crate) fn clip(&self, state: T) -> T {
        if state > self.upper {
            self.upper
        } else if state < -self.lower {
            -self.lower
        } else {
            state
        }
    }

    /// Rate of change of the state. Eq. (4).
    ///
    /// ds/dt = −A s + (B − s) S⁺(u) − (D + s) S⁻(u)
    ///
    /// | symbol | argument | unit |
    /// | --- | --- | --- |
    /// | s | `state` | that of B and D |
    /// | u | `input` | 1/s after scaling: it acts as a rate beside A |
    ///
    /// Used for the analytic command rates. Written as B S⁺ − D S⁻ − (A + |u|) s, which is the same
    /// with one product less.
    #[inline]
    pub fn rate(&self, state: T, input: T) -> T {
        let pull = if input > T::ZERO {
            self.upper
        } else {
            self.lower
        };
        pull * input - (self.decay + input.abs()) * state
    }

    /// The state that a constant input leads to: (B S⁺ − D S⁻)/(A + |u|), inside (−D, B).
    #[inline]
    pub fn equilibrium(&self, input: T) -> T {
        let pull = if input > T::ZERO {
            self.upper
        } else {
            self.lower
        };
        // The quotient first: it is at most 1 even after rounding, so the product stays in bounds.
        pull * (input / (self.decay + input.abs()))
    }

    /// The state after a tick with constant input: the solution of Eq. (4), not an integration step.
    ///
    /// s(dt) = s∞ + (s(0) − s∞) exp(−(A + |u|) dt)
    ///
    /// | | |
    /// | --- | --- |
    /// | `state` | in [−D, B] stays there for every `dt` ≥ 0 and every finite `input`, rounding included; from outside it moves towards the bounds and never away |
    /// | `input` | finite |
    /// | `dt` | s, ≥ 0 |
    ///
    /// Starting outside is the documented relaxation: the distance to the interval shrinks at
    /// least as exp(−A t) and is gone after ln(|s|/bound)/A.
    #[inline]
    pub fn advance<U: NeuronUpdate<T>, M: Maths<T>>(&self, state: T, input: T, dt: T) -> T {
        let longest = T::from_f64(Self::LONGEST);
        let a = dt * (self.decay + input.abs());
        let a = if a < longest { a } else { longest };
        let target = self.equilibrium(input);
        let distance = target - state;
        let next = state + U::share::<M>(a) * distance;
        // The share is at most 1, but the sum may round past the target.
        if distance > T::ZERO {
            if next > target { target } else { next }
        } else if next < target {
            target
        } else {
            next
        }
    }

    /// What is left of a bridge term after a tick: a neuron without input, b(dt) = b(0) exp(−A dt).
    #[inline]
    pub fn fade<U: NeuronUpdate<T>, M: Maths<T>>(&self, dt: T) -> T {
        let longest = T::from_f64(Self::LONGEST);
        let a = dt * self.decay;
        let a = if a < longest { a } else { longest };
        T::ONE - U::share::<M>(a)
    }
}
