//! A neuron in the units of its output: slow gain 1, saturating at a bound.

use crate::error::ParamError;
use crate::maths::Maths;
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::shunting::NeuronParams;
use crate::shunting::{NeuronUpdate, Shunting};

/// Eq. (4) with B = D and its input scaled by A/B: for a constant demand x the state goes to
/// x/(1 + |x|/B), which is x where it is small and never beyond ±B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lag<T> {
    neuron: Shunting<T>,
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
        let scale = decay / bound;
        Ok(Self { neuron, scale })
    }

    /// `demand` within ±B.
    pub(crate) fn clip(&self, demand: T) -> T {
        self.neuron.clip(demand)
    }

    /// The state that starts from `value`, or as near to it as the bound allows.
    pub(crate) fn reset(&self, value: T, demand: T) -> LagState<T> {
        LagState {
            value: self.neuron.clip(value),
            input: self.scale * demand,
        }
    }

    /// The state after a tick, for a demand that was the last one at its begin and is `demand` at its end.
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &self,
        last: &LagState<T>,
        demand: T,
        two_per_dt: T,
    ) -> LagState<T> {
        let input = self.scale * demand;
        let twice = U::twice_input(last.input, input);
        LagState {
            value: self.neuron.advance::<U, M>(last.value, twice, two_per_dt),
            input,
        }
    }

    /// Rate of change of the state, from its own input.
    pub(crate) fn rate(&self, state: &LagState<T>) -> T {
        self.neuron.rate(state.value, state.input)
    }
}
