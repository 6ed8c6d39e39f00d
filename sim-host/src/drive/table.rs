//! Trajectories for a chip: tables for flash, in Rust and in binary.

use super::file::{Retiming, fitted};
use crate::import::{Compact, CompactSample, Tolerance, compact};
use std::fmt::Write as _;

/// How close the chip's interpolation stays to the trajectory: a tenth of what the base makes of
/// it, and well above the rounding of single precision.
pub const TABLE_TOLERANCE: Tolerance = Tolerance {
    position_m: 1.0e-4,
    heading_rad: 1.0e-3,
};

/// Bytes of a sample in a binary table.
pub const SAMPLE_BYTES: usize = 36;

/// A compiled file.
#[derive(Clone, Debug, PartialEq)]
pub struct ChipTable {
    /// Samples and their interpolation error.
    pub compact: Compact,
    /// Name of the constant in Rust.
    pub name: String,
    /// What it was made of, one line.
    pub origin: String,
}

impl ChipTable {
    /// Compiles a trajectory file, time-scaled as a run of it.
    ///
    /// # Errors
    /// A file that is refused, or a base whose limits are not positive.
    pub fn of(
        name: &str,
        bytes: &[u8],
        base: &crate::mission::BaseSpec,
        retiming: &Retiming,
    ) -> Result<Self, super::FileError> {
        let (run, _) = fitted(bytes, base, retiming)?;
        let upper = name.chars().map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_uppercase()
            } else {
                '_'
            }
        });
        let mut constant: String = upper.collect();
        if !constant.starts_with(|c: char| c.is_ascii_alphabetic()) {
            constant.insert_str(0, "TRAJECTORY_");
        }
        Ok(Self {
            compact: compact(&run, TABLE_TOLERANCE),
            name: constant,
            origin: format!("`{name}`, {}, for a {}", run.source(), base.name),
        })
    }

    /// The interpolation error, in words.
    pub fn accuracy(&self) -> String {
        let c = &self.compact;
        format!(
            "within {:.4} mm, {:.4} mrad, {:.4} mm/s and {:.4} mrad/s of the trajectory",
            1e3 * c.position_error_m,
            1e3 * c.heading_error_rad,
            1e3 * c.speed_error,
            1e3 * c.turn_rate_error
        )
    }

    /// A Rust file with one constant, for flash.
    pub fn rust(&self) -> String {
        let samples = &self.compact.samples;
        let mut text = format!(
            "// Made by `sim-host compile` from {}.\n\
             // {} samples of {SAMPLE_BYTES} bytes, {:.3} s. Cubic Hermite interpolation between them\n\
             // (`controller_core::queue::interpolate`, the core's queue) stays\n\
             // {}.\n\
             \n\
             /// Time \\[s\\], x, y \\[m\\], heading \\[rad\\], speed \\[m/s\\], turn rate \\[rad/s\\], the rates of the\n\
             /// last two, and what is left of the last drive \\[m\\]. {}.\n\
             #[rustfmt::skip]\n\
             pub static {}: [[f32; 9]; {}] = [\n",
            self.origin,
            samples.len(),
            samples.last().map_or(0.0, |sample| sample.t),
            self.accuracy(),
            capital(&self.accuracy()),
            self.name,
            samples.len(),
        );
        for sample in samples {
            let numbers = fields(sample).map(|value| format!("{value:?}"));
            // Writing to a string does not fail.
            let _ = writeln!(text, "    [{}],", numbers.join(", "));
        }
        text.push_str("];\n");
        text
    }

    /// The same as little-endian `f32`, 36 bytes a sample: t, x, y, theta, v, w, a, alpha, left.
    pub fn binary(&self) -> Vec<u8> {
        let samples = self.compact.samples.iter();
        samples
            .flat_map(|s| fields(s).map(f32::to_le_bytes))
            .flatten()
            .collect()
    }
}

fn fields(s: &CompactSample) -> [f32; 9] {
    [s.t, s.x, s.y, s.theta, s.v, s.w, s.a, s.alpha, s.left]
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
