//! Seeded random states, the same on every machine.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use crate::oracle::laws::Target;

/// The SplitMix64 generator; the number is its seed.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `n` > 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in \[-scale, scale).
    pub fn within(&mut self, scale: f64) -> f64 {
        scale * ((self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }

    /// Normal, of standard deviation 1, by Box and Muller's rule.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (0.5 * (1.0 - self.within(1.0))).ln()).sqrt();
        radius * self.within(PI).cos()
    }

    /// An error of up to 3 m with any heading.
    pub fn error(&mut self) -> Vector3<f64> {
        Vector3::new(self.within(3.0), self.within(3.0), self.within(PI))
    }

    /// A reference of up to 2 m/s, 2 rad/s, 1 m/s², 1 rad/s².
    pub fn target(&mut self) -> Target {
        Target {
            twist: Vector2::new(self.within(2.0), self.within(2.0)),
            accel: Vector2::new(self.within(1.0), self.within(1.0)),
        }
    }
}
