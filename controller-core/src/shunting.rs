//! The shunting neuron: a leaky integrator whose state cannot leave [−D, B]. Eqs. (4) and (5).

use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::maths::Maths;
use crate::range::{check_ranges, clamp};
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
    /// The present input has a part in the present state, so that an input that is not a number
    /// shows in the torque of the very same tick.
    const USES_PRESENT_INPUT: bool;

    /// Twice the input that is taken to hold over a tick, from its values at both ends. Twice,
    /// because the mean then needs no multiplication.
    fn twice_input(before: T, now: T) -> T;

    /// Share of the way to equilibrium that a tick covers, 1 − exp(−1/x) or an approximation.
    ///
    /// `x` ≥ 0 is the neuron's time constant in ticks, 1/(dt (A + |u|)). The result is in [0, 1) for
    /// every `x`, and at most 1 − 2ε even after rounding: that is what keeps the state in its
    /// bounds without a comparison.
    fn share<M: Maths<T>>(x: T) -> T;
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

/// Mean of inputs, exponential replaced by its [0/2] Padé form: no library call on the chip.
///
/// exp(−a) ≈ 1/(1 + a + a²/2) with a = 1/x gives the share (x + ½)/(x² + x + ½): positive and below
/// 1 for every tick, so the bound on the state holds where an explicit step would leave it or
/// diverge. Second order, like [`ExactMean`]; the share is off by a²/6 of itself, 3e-6 at 1 ms and
/// 3e-4 at 10 ms for A = 4 and small inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RationalMean;

impl<T: Scalar> NeuronUpdate<T> for ExactHeld {
    const USES_PRESENT_INPUT: bool = false;
    #[inline(always)]
    fn twice_input(before: T, _now: T) -> T {
        before + before
    }
    #[inline]
    fn share<M: Maths<T>>(x: T) -> T {
        exact_share::<T, M>(x)
    }
}

impl<T: Scalar> NeuronUpdate<T> for ExactMean {
    const USES_PRESENT_INPUT: bool = true;
    #[inline(always)]
    fn twice_input(before: T, now: T) -> T {
        before + now
    }
    #[inline]
    fn share<M: Maths<T>>(x: T) -> T {
        exact_share::<T, M>(x)
    }
}

impl<T: Scalar> NeuronUpdate<T> for RationalMean {
    const USES_PRESENT_INPUT: bool = true;
    #[inline(always)]
    fn twice_input(before: T, now: T) -> T {
        before + now
    }
    #[inline(always)]
    fn share<M: Maths<T>>(x: T) -> T {
        // The denominator's ½ is 2ε too large: the share stays below 1 − 2ε as x → 0. An x² beyond
        // the largest float makes the share 0, which it is.
        (x + T::HALF) / ((x + (T::HALF + T::EPSILON + T::EPSILON)) + x * x)
    }
}

fn exact_share<T: Scalar, M: Maths<T>>(x: T) -> T {
    let share = -M::exp_m1(-(T::ONE / x));
    let largest = T::ONE - (T::EPSILON + T::EPSILON);
    if share < largest { share } else { largest }
}

/// Coefficients of the shunting neurons, Eq. (4). Each 1e-3 to 1e4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeuronParams<T> {
    /// A \[1/s\]: passive decay rate.
    pub a: T,
    /// B: upper bound of the state.
    pub b: T,
    /// D: the lower bound is −D.
    pub d: T,
}

cast!(NeuronParams { a, b, d });

/// Coefficients A, B, D of Eq. (4), each in [1e-3, 1e4].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shunting<T> {
    decay: T,
    /// B and D, chosen by the sign of the input.
    bounds: [T; 2],
    /// The same, 5ε smaller: where a long tick pulls the state to.
    pull: [T; 2],
    /// 2A.
    twice_decay: T,
    /// 1/(2A).
    half_time: T,
}

impl<T: Scalar> Shunting<T> {
    /// Checks A, B and D.
    ///
    /// # Errors
    /// The first coefficient out of [1e-3, 1e4]. The range leaves the products of a tick finite.
    pub fn new(params: &NeuronParams<T>) -> Result<Self, ParamError> {
        let NeuronParams {
            a: decay,
            b: upper,
            d: lower,
        } = *params;
        check_ranges![
            (Field::DecayA, decay, 1.0e-3, 1.0e4),
            (Field::UpperB, upper, 1.0e-3, 1.0e4),
            (Field::LowerD, lower, 1.0e-3, 1.0e4),
        ]?;
        let shy = T::ONE - T::from_f64(5.0) * T::EPSILON;
        Ok(Self {
            decay,
            bounds: [upper, lower],
            pull: [shy * upper, shy * lower],
            twice_decay: decay + decay,
            half_time: T::HALF / decay,
        })
    }

    /// What a long tick with a positive input pulls the state to.
    pub(crate) fn pull(&self) -> T {
        self.pull[0]
    }

    /// A \[1/s\].
    pub fn decay(&self) -> T {
        self.decay
    }

    /// B, the upper bound of the state.
    pub fn upper(&self) -> T {
        self.bounds[0]
    }

    /// −D, the lower bound of the state.
    pub fn lower(&self) -> T {
        -self.bounds[1]
    }

    /// `state` is in [−D, B].
    pub fn contains(&self, state: T) -> bool {
        state >= -self.bounds[1] && state <= self.bounds[0]
    }

    /// The state in [−D, B] nearest to `state`, which may be infinite.
    pub(crate) fn clip(&self, state: T) -> T {
        if state > self.bounds[0] {
            self.bounds[0]
        } else if state < -self.bounds[1] {
            -self.bounds[1]
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
    #[inline(always)]
    pub fn rate(&self, state: T, input: T) -> T {
        rate(
            self.bounds[input.sign_index() & 1],
            self.decay,
            state,
            input,
        )
    }

    /// The state that a constant input leads to: (B S⁺ − D S⁻)/(A + |u|), inside (−D, B).
    pub fn equilibrium(&self, input: T) -> T {
        // The quotient first: it is at most 1 even after rounding, so the product stays in bounds.
        self.bounds[input.sign_index() & 1] * (input / (self.decay + input.abs()))
    }

    /// The state after a tick: the solution of Eq. (4) for a held input, not an integration step.
    ///
    /// s(dt) = s∞ + (s(0) − s∞) exp(−(A + |u|) dt)
    ///
    /// | argument | |
    /// | --- | --- |
    /// | `state` | in [−D, B] stays there, rounding included; from outside it moves towards the bounds and never away |
    /// | `twice_input` | 2u, finite, below 1e31 in magnitude |
    /// | `two_per_dt` | 2/dt \[1/s\], 0 to 1e18 |
    ///
    /// Why rounding cannot leave the bounds: s∞ is at most (1 − 5ε) B by the choice of `pull`; the
    /// share is at most 1 − 2ε, so that share · (s∞ − s), with its two roundings, is at most the exact
    /// distance; and a sum below a float rounds to at most that float. `docs/derivation.md` has the
    /// whole argument, and the tests try it.
    ///
    /// Starting outside is the documented relaxation. With the exact updates the state shrinks at
    /// least as exp(−A t) until it is inside, after ln(|s|/bound)/A at most; with the rational one as
    /// fast for ticks short against 1/A, and by at least half the way for one of them.
    #[inline(always)]
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &self,
        state: T,
        twice_input: T,
        two_per_dt: T,
    ) -> T {
        let pull = self.pull[twice_input.sign_index() & 1];
        advance::<T, U, M>(pull, self.twice_decay, state, twice_input, two_per_dt)
    }

    /// The state after `dt` ≥ 0 \[s\] with a finite input known at both ends, whatever their
    /// magnitudes: the tick of Eq. (17) for use on its own.
    ///
    /// A state in [−D, B] stays there, rounding included. From outside it relaxes: it moves towards
    /// the bounds and never away.
    ///
    /// Inputs beyond 1e30 act like 1e30, whose equilibrium is already the bound to the last bit; a
    /// `dt` below 2e-18 s acts like 2e-18 s, and 0 changes nothing.
    pub fn step<U: NeuronUpdate<T>, M: Maths<T>>(&self, state: T, input: (T, T), dt: T) -> T {
        if dt == T::ZERO {
            return state;
        }
        let largest = T::from_f64(1.0e30);
        let twice = U::twice_input(clamp(input.0, largest), clamp(input.1, largest));
        self.advance::<U, M>(
            state,
            twice,
            clamp((T::ONE + T::ONE) / dt, T::from_f64(1.0e18)),
        )
    }

    /// The share of a transition offset that fades over a tick: that of a neuron without input.
    #[inline(always)]
    pub(crate) fn fading<U: NeuronUpdate<T>, M: Maths<T>>(&self, two_per_dt: T) -> T {
        U::share::<M>(self.half_time * two_per_dt)
    }
}

/// [`Shunting::rate`] with the `bound` on the input's side.
#[inline(always)]
pub(crate) fn rate<T: Scalar>(bound: T, decay: T, state: T, input: T) -> T {
    bound * input - (decay + input.abs()) * state
}

/// [`Shunting::advance`] with what the input's side pulls to.
#[inline(always)]
pub(crate) fn advance<T: Scalar, U: NeuronUpdate<T>, M: Maths<T>>(
    pull: T,
    twice_decay: T,
    state: T,
    twice_input: T,
    two_per_dt: T,
) -> T {
    // 1/(2 (A + |u|)): with 2u and 2/dt the twos cancel.
    let half_time = T::ONE / (twice_decay + twice_input.abs());
    let target = pull * (twice_input * half_time);
    state + U::share::<M>(half_time * two_per_dt) * (target - state)
}
