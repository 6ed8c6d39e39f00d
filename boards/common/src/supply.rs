//! What the bridges are fed with.

/// Measures the motor supply.
pub trait Supply {
    /// Volts; `None` where nothing has measured them since the last call. Called in every tick, and does not wait.
    fn volts(&mut self) -> Option<f32>;
}

/// The supply of a board that does not measure it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoSupply;

impl Supply for NoSupply {
    fn volts(&mut self) -> Option<f32> {
        None
    }
}

/// A board that measures it only where its configuration says that something is wired to the pin.
impl<S: Supply> Supply for Option<S> {
    fn volts(&mut self) -> Option<f32> {
        self.as_mut().and_then(S::volts)
    }
}
