//! Reproducible inputs, the same on every board.

use controller_core::scalar::Scalar;

/// A linear congruential generator; its upper bits are good enough to draw inputs.
pub struct Inputs(u32);

impl Inputs {
    pub const fn new(seed: u32) -> Self {
        Self(seed)
    }

    /// The state after another step.
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }

    /// In [−scale, scale).
    pub fn real<T: Scalar>(&mut self, scale: f32) -> T {
        let unit = (self.bits() as i32 >> 8) as f32 * (1.0 / 8_388_608.0);
        T::from_f64(f64::from(unit * scale))
    }
}
