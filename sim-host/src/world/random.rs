//! Random numbers: a stream of its own for each source, so that switching one noise off leaves the
//! others bit for bit.

use rand_distr::{Distribution, LogNormal, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

/// Who draws.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stream {
    Tick = 1,
    Glitch,
    PoseDrop,
    PosePosition,
    PoseHeading,
    Supply,
    Current,
    GyroDraw,
    GyroNoise,
    GyroWalk,
}

/// One stream. What is drawn never depends on what the numbers are used for.
#[derive(Clone, Debug)]
pub(super) struct Random(Pcg64);

impl Random {
    pub fn new(seed: u64, stream: Stream) -> Self {
        let stream = stream as u64;
        let word = |n: u64| {
            u128::from(scrambled(seed.wrapping_add(
                GOLDEN.wrapping_mul(stream.wrapping_mul(4).wrapping_add(n)),
            )))
        };
        // Streams of one state would be shifted copies of each other, so the states differ too.
        Self(Pcg64::new(word(0) << 64 | word(1), u128::from(stream)))
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Evenly in 0 to 1, without 1.
    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    /// Log-normal of a median and a standard deviation of the logarithm, which are in range.
    pub fn log_normal(&mut self, median: f64, spread: f64) -> f64 {
        let standard = LogNormal::new(0.0, spread).map_or(1.0, |d| d.sample(&mut self.0));
        median * standard
    }
}

/// 2⁶⁴ divided by the golden ratio: Weyl's sequence with it covers all words evenly.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of SplitMix64: near seeds give far states.
fn scrambled(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}
