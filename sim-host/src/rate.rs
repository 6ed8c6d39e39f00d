//! How often something fails, and how well that is known from a number of runs.

use statrs::distribution::{Beta, ContinuousCDF};

/// Failures among independent runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rate {
    /// Runs that failed; at most `runs`.
    pub failed: usize,
    /// All runs.
    pub runs: usize,
}

impl Rate {
    /// Clopper and Pearson's interval \[1\], which holds the true rate in at least 95 % of all studies: two-sided, or,
    /// without any failure, from 0 to the bound that 95 % of all studies would pass with one.
    pub fn interval(&self) -> (f64, f64) {
        let tail = if self.failed == 0 || self.failed >= self.runs {
            0.05
        } else {
            0.025
        };
        clopper_pearson(self.failed, self.runs, tail)
    }

    /// More than the `stated` one, and not by chance: their intervals do not meet.
    pub fn exceeds(&self, stated: &Self) -> bool {
        self.interval().0 > stated.interval().1
    }
}

/// Clopper and Pearson's interval \[1\] for a share of which `hits` of `runs` were seen: at most the probability `tail` is
/// beyond each end.
pub fn clopper_pearson(hits: usize, runs: usize, tail: f64) -> (f64, f64) {
    let (hits, others) = (hits as f64, runs.saturating_sub(hits) as f64);
    let quantile = |a: f64, b: f64, share: f64| Beta::new(a, b).map(|d| d.inverse_cdf(share));
    // Not a distribution: there was none, or nothing else.
    let low = quantile(hits, others + 1.0, tail).unwrap_or(0.0);
    let high = quantile(hits + 1.0, others, 1.0 - tail).unwrap_or(1.0);
    (low, high)
}

impl std::fmt::Display for Rate {
    /// `0 of 900 runs, at most 0.33 %`, or `12 of 900 runs, 1.33 % (0.69 to 2.32 %)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (low, high) = self.interval();
        write!(f, "{} of {} runs, ", self.failed, self.runs)?;
        if self.failed == 0 {
            write!(f, "at most {:.2} %", 1e2 * high)
        } else {
            let rate = self.failed as f64 / self.runs as f64;
            write!(
                f,
                "{:.2} % ({:.2} to {:.2} %)",
                1e2 * rate,
                1e2 * low,
                1e2 * high
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Rate;

    /// No failure in n runs: 1 − 0.05^(1/n), the rule of three. Ten of a hundred: the published 4.90 to 17.62 %.
    #[test]
    fn intervals_are_those_of_clopper_and_pearson() {
        let none = Rate {
            failed: 0,
            runs: 900,
        };
        let (low, high) = none.interval();
        assert_eq!(low, 0.0);
        assert!((high - (1.0 - 0.05_f64.powf(1.0 / 900.0))).abs() < 1e-9);
        let ten = Rate {
            failed: 10,
            runs: 100,
        };
        let (low, high) = ten.interval();
        assert!((low - 0.0490).abs() < 1e-4 && (high - 0.1762).abs() < 1e-4);
        assert_eq!(Rate { failed: 3, runs: 3 }.interval().1, 1.0, "all failed");
        assert_eq!(none.to_string(), "0 of 900 runs, at most 0.33 %");
    }
}
