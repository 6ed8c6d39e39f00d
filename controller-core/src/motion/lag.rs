//! A neuron in the units of its output: slow gain 1, saturating at a bound.

use crate::error::ParamError;
use crate::maths::Maths;
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::shunting::{self, NeuronParams, NeuronUpdate, Shunting};

/// Eq. (4) with B = D and its input scaled by A/B: for a constant demand x the state goes to
/// x/(1 + |x|/B), which is x where it is small and never beyond ±B. A is lent: all neurons of a pose law have the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lag<T> {
    /// B, and the same as a long tick pulls the state to it.
    bound: T,
    pull: T,
    /// A/B.
    scale: T,
}

/// State of a [`Lag`] and the input that it had at the last tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LagState<T> {
    pub(crate) value: T,
    input: T,
}

impl<T: Scalar> LagState<T> {
    /// At rest.
    pub(crate) const NEW: Self = Self {
        value: T::ZERO,
        input: T::ZERO,
    };

    /// More than a rounding of 1 is left of what was demanded. A decay alone ends in numbers that rounding keeps from zero.
    #[inline(always)]
    pub(crate) fn is_felt(&self) -> bool {
        self.value.abs() > T::EPSILON
    }

    pub(crate) fn residue(&self) -> T {
        residue([self.value, self.input])
    }
}

impl<T: Scalar> Lag<T> {
    pub(crate) fn new(decay: T, bound: T) -> Result<Self, ParamError> {
        let neuron = Shunting::new(&NeuronParams {
            a: decay,
            b: bound,
            d: bound,
        })?;
        Ok(Self {
            bound,
            pull: neuron.pull(),
            scale: decay / bound,
        })
    }

    /// `demand` within ±B.
    pub(crate) fn clip(&self, demand: T) -> T {
        clamp(demand, self.bound)
    }

    /// The constant demand that leads to `value` > 0: x/(1 + x/B) = v. None does to the bound and beyond.
    pub(crate) fn demand_for(&self, value: T) -> T {
        if value < self.bound {
            value * self.bound / (self.bound - value)
        } else {
            T::MAX
        }
    }

    /// The state that starts from `value`, or as near to it as the bound allows.
    pub(crate) fn reset(&self, value: T, demand: T) -> LagState<T> {
        LagState {
            value: self.clip(value),
            input: self.scale * demand,
        }
    }

    /// The state after a tick, for a demand that was the last one at its begin and is `demand` at its end.
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &self,
        last: &LagState<T>,
        demand: T,
        decay: T,
        two_per_dt: T,
    ) -> LagState<T> {
        let input = self.scale * demand;
        let twice = U::twice_input(last.input, input);
        LagState {
            value: shunting::advance::<T, U, M>(
                self.pull,
                decay + decay,
                last.value,
                twice,
                two_per_dt,
            ),
            input,
        }
    }

    /// Rate of change of the state, from its own input.
    pub(crate) fn rate(&self, state: &LagState<T>, decay: T) -> T {
        shunting::rate(self.bound, decay, state.value, state.input)
    }
}
