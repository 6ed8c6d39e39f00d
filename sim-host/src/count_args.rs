//! Counts that have a limit.

use sim_host::part::MAX_SEEDS;
use sim_host::tune::MAX_EVALUATIONS;
use std::num::{NonZeroU32, NonZeroU64};
use std::str::FromStr;

/// Worlds of each case.
pub fn seeds(text: &str) -> Result<NonZeroU32, String> {
    up_to(MAX_SEEDS.get().into(), text)
}

/// Sets of gains that are tried.
pub fn evaluations(text: &str) -> Result<NonZeroU64, String> {
    up_to(MAX_EVALUATIONS, text)
}

/// A whole number above 0 with a limit.
fn up_to<N: FromStr + Copy + Into<NonZeroU64>>(most: u64, text: &str) -> Result<N, String> {
    let number = text.parse::<N>().ok();
    number
        .filter(|number| (*number).into().get() <= most)
        .ok_or_else(|| format!("must be a whole number in 1 to {most}"))
}
