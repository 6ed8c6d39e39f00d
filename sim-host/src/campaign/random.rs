//! Random numbers of a run.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Mcg;

/// A stream that a seed and the number of a run settle.
#[derive(Clone, Debug)]
pub(super) struct Random(Pcg64Mcg);

/// 2⁶⁴ divided by the golden ratio: numbers of runs that follow each other give seeds far apart.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    pub fn new(seed: u64, run: u64) -> Self {
        let word = seed.rotate_left(32) ^ GOLDEN.wrapping_mul(run.wrapping_add(1));
        Self(Pcg64Mcg::seed_from_u64(word))
    }

    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }

    pub fn word(&mut self) -> u64 {
        StandardUniform.sample(&mut self.0)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    pub fn below(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count - 1)
    }
}
