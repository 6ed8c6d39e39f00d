//! Where random numbers begin, and how many worlds are drawn by them.

use clap::Args;
use sim_host::part::MAX_SEEDS;
use std::num::{NonZeroU32, NonZeroU64};
use std::str::FromStr;

/// Where random numbers begin.
#[derive(Clone, Copy, Debug, Args)]
pub struct SeedArgs {
    /// Settles all that is random: the same number gives the same runs
    #[arg(long, value_name = "S", default_value = "1")]
    seed: u64,
    /// Draw a seed that nobody has seen; it is printed, so that the runs can be repeated with --seed
    #[arg(long, conflicts_with = "seed")]
    pub fresh: bool,
}

impl SeedArgs {
    /// The seed to use.
    ///
    /// # Errors
    /// The operating system has no random numbers.
    pub fn draw(&self) -> Result<u64, getrandom::Error> {
        if self.fresh {
            // Ten digits are enough to be new, and can be typed.
            getrandom::u32().map(u64::from)
        } else {
            Ok(self.seed)
        }
    }
}

/// Worlds of each case.
pub fn seeds(text: &str) -> Result<NonZeroU32, String> {
    up_to(MAX_SEEDS.get().into(), text)
}

/// A whole number above 0 with a limit.
pub fn up_to<N: FromStr + Copy + Into<NonZeroU64>>(most: u64, text: &str) -> Result<N, String> {
    let number = text.parse::<N>().ok();
    number
        .filter(|number| (*number).into().get() <= most)
        .ok_or_else(|| format!("must be a whole number in 1 to {most}"))
}
