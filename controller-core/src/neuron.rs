//! A neuron on its own: coefficients and a state that is inside [−D, B] for ever. Eq. (4).

use crate::error::NeuronError;
use crate::maths::Maths;
use crate::scalar::Scalar;
use crate::shunting::{NeuronUpdate, Shunting};

/// One shunting neuron with its state.
///
/// ```
/// use controller_core::maths::Libm;
/// use controller_core::neuron::Neuron;
/// use controller_core::shunting::NeuronParams;
/// use controller_core::shunting::{ExactHeld, Shunting};
///
/// let shunting = Shunting::new(&NeuronParams { a: 4.0, b: 4.0, d: 4.0 })?;
/// let mut neuron = Neuron::new(shunting, 0.0)?;
/// // A huge error for a long time: the neuron saturates at B, it does not wind up.
/// assert!(neuron.advance::<ExactHeld, Libm>(1.0e30, 10.0)? <= 4.0);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neuron<T> {
    shunting: Shunting<T>,
    state: T,
}

impl<T: Scalar> Neuron<T> {
    /// A neuron at `state`.
    ///
    /// # Errors
    /// [`NeuronError::OutOfBounds`] if `state` is outside [−D, B] or not a number.
    pub fn new(shunting: Shunting<T>, state: T) -> Result<Self, NeuronError> {
        if shunting.contains(state) {
            Ok(Self { shunting, state })
        } else {
            Err(NeuronError::OutOfBounds)
        }
    }

    /// The state, in [−D, B].
    pub fn state(&self) -> T {
        self.state
    }

    /// Advances over `dt` ≥ 0 \[s\] with a held input and returns the new state.
    ///
    /// `dt` may be infinite: the neuron is then at its equilibrium. See [`Shunting::step`].
    ///
    /// # Errors
    /// An input that is not finite, or a `dt` that is negative or NaN; the state is unchanged.
    pub fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        input: T,
        dt: T,
    ) -> Result<T, NeuronError> {
        if !input.is_finite() {
            return Err(NeuronError::InputNotFinite);
        }
        if dt >= T::ZERO {
            self.state = self.shunting.step::<U, M>(self.state, (input, input), dt);
            Ok(self.state)
        } else {
            Err(NeuronError::TickNegative)
        }
    }
}
