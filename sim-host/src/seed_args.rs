//! Where random numbers begin.

use clap::Args;

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
