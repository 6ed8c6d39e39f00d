//! The lags of both motors: fitted with the motion, told, and taken out of its information.
//!
//! A winding's current follows the voltage late by L/R, a driver's torque its command by its own
//! time. Nothing here asks for them, but without them mass, friction and resistance would be off by
//! more than their intervals.

use super::fit::Fit;
use super::{Entry, SIDES, VAGUE, Verdict};
use nalgebra::{DMatrix, DVector};

/// Right, left; the last parameters of the motion.
pub(super) const LAGS: usize = 2;
/// A typical one \[s\].
pub(super) const TYPICAL_S: f64 = 1.0e-3;
/// Standard deviation of a lag about 0 before anything is known \[s\]: L/R of small motors is 0.1 to
/// 1 ms, PWM holds a command back by its period of 0.05 to 0.1 ms, a driver's loop by 1 ms or two.
/// A good drive shows a lag to 0.02 ms: that of 1 ms is moved by less than a hundredth of that. Where
/// a drive shows none, what a lag can do to mass and friction stays within reason.
pub(super) const BEFORE_S: f64 = 2.0e-3;
/// The same where there shall be none: a tenth of what good drives show.
pub(super) const NONE_S: f64 = 1.0e-6;
/// Angles may be sampled this much after their row's time \[s\], so that motors seem early.
const SAMPLED_S: f64 = 1.0e-4;

/// Lags \[s\], their standard deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lags {
    value: [f64; LAGS],
    deviation: [f64; LAGS],
}

/// Those of the parameters of the motion.
pub(super) fn of(global: &[f64]) -> [f64; LAGS] {
    let first = global.len() - LAGS;
    [global[first], global[first + 1]]
}

/// What is known before of `count` parameters of the motion, the lags to `deviation` \[s\] about 0:
/// inverse variances.
pub(super) fn prior(count: usize, deviation: f64) -> DVector<f64> {
    let known = 1.0 / (deviation * deviation);
    DVector::from_fn(count, |i, _| if i + LAGS < count { 0.0 } else { known })
}

/// The fit of all else, with the information that is left if the lags are free, and the lags.
pub(super) fn set_apart(fit: Fit) -> (Fit, Lags) {
    let kept = fit.value.len() - LAGS;
    let covariance = covariance(&fit.information);
    let lags = Lags {
        value: of(fit.value.as_slice()),
        deviation: [0, 1].map(|i| covariance[(kept + i, kept + i)].max(0.0).sqrt()),
    };
    let fit = Fit {
        value: fit.value.rows(0, kept).into_owned(),
        information: without(&fit.information, kept),
        ..fit
    };
    (fit, lags)
}

/// Information about the first `kept` parameters a with all others b free (Schur's complement):
///
/// ```text
/// H = H_aa - H_ab H_bb^-1 H_ba
/// ```
fn without(h: &DMatrix<f64>, kept: usize) -> DMatrix<f64> {
    let free = h.nrows() - kept;
    let own = h.view((0, 0), (kept, kept)).into_owned();
    let shared = h.view((0, kept), (kept, free));
    // What is known before makes H_bb positive, so that there is an inverse.
    let others = h.view((kept, kept), (free, free)).into_owned();
    let Some(inverse) = others.try_inverse() else {
        return own;
    };
    let rest = own - shared * inverse * shared.transpose();
    // Symmetric but for rounding, which eigenvalues must not see.
    0.5 * (&rest + rest.transpose())
}

/// Inverse of the information; of directions that the data do not show, which no lag has, nothing.
fn covariance(h: &DMatrix<f64>) -> DMatrix<f64> {
    // In units of the parameters' own information, for these differ by 1e12.
    let unit = h
        .diagonal()
        .map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
    let unit = DMatrix::from_diagonal(&unit);
    let mut eigen = (&unit * h * &unit).symmetric_eigen();
    eigen.eigenvalues = eigen
        .eigenvalues
        .map(|v| if v > 1.0e-13 { 1.0 / v } else { 0.0 });
    &unit * eigen.recompose() * &unit
}

impl Lags {
    /// Whether a motor moves its wheel before its command, which is no lag: by more than angles are
    /// sampled late, and not by chance.
    pub(super) fn early(&self) -> bool {
        (0..LAGS).any(|i| self.value[i] + SAMPLED_S + 3.0 * self.deviation[i] < 0.0)
    }

    /// What makes that doubtful.
    pub(super) fn warning(&self) -> Option<String> {
        let least = self.value[0].min(self.value[1]);
        self.early().then(|| {
            format!(
                "wheels move {:.1} ms before their commands: tyres that give, a slope, or commands or angles \
                 of another time than their row's; motors are taken as without lag",
                -1.0e3 * least
            )
        })
    }

    /// Those that the log shows, to half of what was known before at least.
    pub(super) fn entries(&self, quantile: f64) -> Vec<Entry> {
        let shown = |i: usize| {
            let half_width = quantile * self.deviation[i];
            let verdict = Verdict::Identified {
                value: self.value[i],
                half_width,
            };
            let meaning = "from command to torque: winding and driver";
            let name = format!("lag_{}", SIDES[i]);
            (!self.early() && half_width <= VAGUE * BEFORE_S)
                .then(|| Entry::new(&name, "s", meaning, verdict))
        };
        (0..LAGS).filter_map(shown).collect()
    }
}
