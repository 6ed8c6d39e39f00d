//! Sine and cosine of a heading that changes little at a time.

use controller_core::maths::{Libm, Maths};

/// A heading with its sine and cosine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    heading: f64,
    pub sine: f64,
    pub cosine: f64,
}

/// Largest turn δ of which a series is taken \[rad\]: what is left out, δ⁷/5040 and δ⁸/40320, is below 2⁻⁵⁸.
const SMALL: f64 = 0.01;

impl Facing {
    pub fn new(heading: f64) -> Self {
        let (sine, cosine) = Libm::sin_cos(heading);
        Self {
            heading,
            sine,
            cosine,
        }
    }

    /// Turned to `heading`. Each small turn rounds once more: after a thousand of them sine and cosine are still good to 1e-13.
    #[inline(always)]
    pub fn at(&self, heading: f64) -> Self {
        let turn = heading - self.heading;
        if turn.abs() > SMALL {
            return Self::new(heading);
        }
        let square = turn * turn;
        let sine = turn * (1.0 - square * (1.0 / 6.0 - square / 120.0));
        // 1 − cos δ.
        let less = square * (0.5 - square * (1.0 / 24.0 - square / 720.0));
        Self {
            heading,
            sine: self.sine + (self.cosine * sine - self.sine * less),
            cosine: self.cosine - (self.sine * sine + self.cosine * less),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_turns_add_up() {
        for step in [1.0e-9, 1.0e-4, 0.009_9, -0.003, 0.5] {
            let mut facing = Facing::new(1.0);
            for turn in 1..=1000 {
                let heading = 1.0 + step * f64::from(turn);
                facing = facing.at(heading);
                let (sine, cosine) = heading.sin_cos();
                let error = (facing.sine - sine)
                    .abs()
                    .max((facing.cosine - cosine).abs());
                assert!(error < 1.0e-13, "{turn} turns of {step}: {error:e}");
            }
        }
    }
}
