//! How often the true value lies in the stated interval.

use crate::robot::Robot;
use rayon::prelude::*;
use sim_host::identify::{Identified, Quantity, Verdict};

/// What many logs said of a quantity.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    /// Logs that gave a number.
    pub given: usize,
    /// Of these, those whose interval held the true value.
    pub within: usize,
    /// Sum of half widths over values.
    width: f64,
    /// Sum of errors over half widths.
    bias: f64,
    /// Sum of errors over values.
    error: f64,
}

impl Tally {
    /// Mean error \[% of the true value\].
    pub fn error_percent(&self) -> f64 {
        100.0 * self.error / self.given as f64
    }
}

pub type Tallies = [Tally; 15];

/// One log against its robot.
pub fn of(found: &Identified, robot: &Robot) -> Tallies {
    Quantity::ALL.map(|quantity| match found.of(quantity) {
        Some(Verdict::Identified { value, half_width }) => {
            let off = value - robot.truth(quantity);
            Tally {
                given: 1,
                within: usize::from(off.abs() <= *half_width),
                width: half_width / value.abs(),
                bias: off / half_width,
                error: off / robot.truth(quantity),
            }
        }
        _ => Tally::default(),
    })
}

/// The sum over seeds 0 to `logs`, on all cores.
pub fn all(logs: usize, one: impl Fn(u64) -> Tallies + Sync + Send) -> Tallies {
    let add = |mut sum: Tallies, one: Tallies| {
        for (sum, one) in sum.iter_mut().zip(one) {
            sum.given += one.given;
            sum.within += one.within;
            sum.width += one.width;
            sum.bias += one.bias;
            sum.error += one.error;
        }
        sum
    };
    // Summed in the order of seeds whichever is done first.
    let tallies: Vec<_> = (0..logs as u64).into_par_iter().map(one).collect();
    tallies.into_iter().fold([Tally::default(); 15], add)
}

/// A line for each quantity that got numbers.
pub fn print(name: &str, tallies: &Tallies) {
    println!("{name}:");
    for (quantity, tally) in Quantity::ALL.iter().zip(tallies) {
        let given = tally.given as f64;
        if tally.given > 0 {
            println!(
                "  {:22} {:3} logs, {:5.1} % within, mean half width {:.2} %, mean error {:+.2} half widths, {:+.2} %",
                quantity.name(),
                tally.given,
                100.0 * tally.within as f64 / given,
                100.0 * tally.width / given,
                tally.bias / given,
                tally.error_percent(),
            );
        }
    }
}
