//! Between command and wheel: lags, gear losses and dead bands of both motors. They are fitted with the motion,
//! reported, and taken out of its information.
//!
//! Nothing asks for them first, but without them mass, friction and resistance would be off by more than their
//! intervals.
//!
//! | parameter | meaning | shown by |
//! | --- | --- | --- |
//! | lag \[s\] | a winding's current follows the voltage by L/R, a driver's torque its command by its own time | steps of the command |
//! | loss, 1 - efficiency | share of a motor's torque that teeth hold back against the turn | the same wheel driving and braking |
//! | dead band | share of full duty that a driver loses at either sign (dead time, diodes) | currents |
//! | source \[ohm\], drain \[V\] | what the supply sags by under currents, and over the log | the measured supply, before the fit |

use super::fit::Fit;
use super::log::{Drive, Log};
use super::quantity::{Known, Stated};
use super::source::Source;
use super::{Entry, SIDES, Verdict};
use nalgebra::{DMatrix, DVector};

/// Lags, losses, bands, each right, left, and the battery's resistance and drain: the last parameters of the motion, as
/// departures from what is known before.
pub(super) const COUNT: usize = 8;
/// Typical sizes of them.
pub(super) const TYPICAL: [f64; COUNT] = [1.0e-3, 1.0e-3, 0.1, 0.1, 0.01, 0.01, 0.01, 0.01];
/// Standard deviation of a lag about 0 before anything is known \[s\]: L/R of small motors is 0.1 to
/// 1 ms, PWM holds a command back by its period of 0.05 to 0.1 ms, a driver's loop by 1 ms or two.
/// A good drive shows a lag to 0.02 ms: that of 1 ms is moved by less than a hundredth of that. Where
/// a drive shows none, what a lag can do to mass and friction stays within reason.
const LAG_S: f64 = 2.0e-3;
/// The same where there shall be none: a tenth of what good drives show.
const NO_LAG_S: f64 = 1.0e-6;
/// Loss before anything is known: spur and planetary gears have 0.02 to 0.4, worms more. Where a drive
/// does not show it, mass stays uncertain by more than half, which is no number.
const LOSS: Stated = Stated {
    value: 0.2,
    deviation: 0.3,
};
/// Dead band before anything is known: bridges lose 0 to 5 % to dead time and diodes.
const BAND: Stated = Stated {
    value: 0.0,
    deviation: 0.05,
};
/// Deviation of a stated loss or band: a hundredth of what good drives show.
const EXACT: f64 = 1.0e-5;
/// What is there by no means, or stated as exact.
const fn exactly(value: f64) -> Stated {
    Stated {
        value,
        deviation: EXACT,
    }
}
/// Angles may be sampled this much after their row's time \[s\], so that motors seem early.
const SAMPLED_S: f64 = 1.0e-4;
/// An interval above this share of what was known before is no finding.
const SHOWN: f64 = 0.5;

/// What is known of the parameters before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Before([Stated; COUNT]);

impl Before {
    /// Voltages at the motor have no dead band, and torques at the wheel neither that nor losses, but what is stated.
    pub(super) fn new(log: &Log, known: &Known, source: &Source) -> Self {
        let lag = Stated {
            value: 0.0,
            deviation: LAG_S,
        };
        let loss = match (known.efficiency, log.drive) {
            (Some(stated), _) => Stated {
                value: 1.0 - stated.value,
                deviation: stated.deviation.max(EXACT),
            },
            (None, Drive::Torque) => exactly(0.0),
            (None, Drive::Voltage | Drive::Duty) => LOSS,
        };
        let band = match known.dead_band {
            _ if !log.of_duties() => exactly(0.0),
            Some(stated) => Stated {
                value: stated.value,
                deviation: stated.deviation.max(EXACT),
            },
            None => BAND,
        };
        let [ohm, drain] = [source.ohm, source.drain].map(|known| Stated {
            deviation: known.deviation.max(EXACT),
            ..known
        });
        Self([lag, lag, loss, loss, band, band, ohm, drain])
    }

    /// The same with motors that have no lag.
    pub(super) fn without_lag(mut self) -> Self {
        for lag in &mut self.0[..2] {
            lag.deviation = NO_LAG_S;
        }
        self
    }

    /// Where a fit begins that has these guesses: at no lag.
    pub(super) fn start(&self, loss: [Option<f64>; 2], band: [Option<f64>; 2]) -> [f64; COUNT] {
        let mut start = [0.0; COUNT];
        for (i, guess) in (2..6).zip(loss.into_iter().chain(band)) {
            let Stated { value, deviation } = self.0[i];
            // Within what is known before; a statement is not left for a guess.
            start[i] = guess.map_or(0.0, |guess| (guess - value).clamp(-deviation, deviation));
        }
        start
    }

    /// Inverse variances of `count` parameters of the motion about 0.
    pub(super) fn prior(&self, count: usize) -> DVector<f64> {
        let known = self.0.map(|known| known.deviation.powi(-2));
        DVector::from_fn(count, |i, _| {
            (i + COUNT).checked_sub(count).map_or(0.0, |i| known[i])
        })
    }

    /// Those among the parameters of the motion.
    pub(super) fn of(&self, global: &[f64]) -> Drivetrain {
        let first = global.len() - COUNT;
        let value = |i: usize| self.0[i].value + global[first + i];
        Drivetrain {
            lag: [value(0), value(1)],
            loss: [value(2), value(3)],
            band: [value(4), value(5)],
            source_ohm: value(6),
            drain: value(7),
        }
    }

    /// The fit of all else, with the information that is left if these are free, and these.
    pub(super) fn set_apart(&self, fit: Fit) -> (Fit, Found) {
        let kept = fit.value.len() - COUNT;
        let covariance = covariance(&fit.information);
        let found = Found {
            value: std::array::from_fn(|i| self.0[i].value + fit.value[kept + i]),
            deviation: std::array::from_fn(|i| covariance[(kept + i, kept + i)].max(0.0).sqrt()),
            before: *self,
            largest_lag_s: None,
        };
        let fit = Fit {
            value: fit.value.rows(0, kept).into_owned(),
            information: without(&fit.information, kept),
            ..fit
        };
        (fit, found)
    }
}

/// Values, right and left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drivetrain {
    pub(super) lag: [f64; 2],
    pub(super) loss: [f64; 2],
    pub(super) band: [f64; 2],
    pub(super) source_ohm: f64,
    /// Volts over the log.
    pub(super) drain: f64,
}

/// What a log shows of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    value: [f64; COUNT],
    deviation: [f64; COUNT],
    before: Before,
    /// The largest lag that is solved \[s\], of a log that shows lags.
    largest_lag_s: Option<f64>,
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
    let Some(inverse) = inverse(&others) else {
        return own;
    };
    let rest = own - shared * inverse * shared.transpose();
    // Symmetric but for rounding, which eigenvalues must not see.
    0.5 * (&rest + rest.transpose())
}

/// Of a positive matrix, in units of its own diagonal, for that differs by 1e12.
fn inverse(h: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let unit = DMatrix::from_diagonal(&h.diagonal().map(|d| 1.0 / d.sqrt()));
    let inverse = (&unit * h * &unit).try_inverse()?;
    Some(&unit * inverse * &unit)
}

/// Inverse of the information; of directions that the data do not show, which none of these has, nothing.
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

impl Found {
    /// Whether a motor moves its wheel before its command, which is no lag: by more than angles are
    /// sampled late, and not by chance.
    pub(super) fn early(&self) -> bool {
        (0..2).any(|i| self.value[i] + SAMPLED_S + 3.0 * self.deviation[i] < 0.0)
    }

    /// The same, of a log that shows lags if there is a largest one that is solved \[s\].
    pub(super) fn with_lags(mut self, largest_lag_s: Option<f64>) -> Self {
        self.largest_lag_s = largest_lag_s;
        self
    }

    /// Why this is the motion of no motors that are solved here.
    pub(super) fn spoilt(&self, log: &Log) -> Option<&'static str> {
        // Not by chance.
        let beyond =
            |largest_s| (0..2).any(|i| self.value[i] - 3.0 * self.deviation[i] > largest_s);
        if self.largest_lag_s.is_some_and(beyond) {
            return Some(
                "the torque follows the commands with a lag of a sixth of the time in which the wheels settle, or more: drivers at a \
                 current limit that is not stated (current_limit), or motors for which there is no model",
            );
        }
        self.sags(log)
    }

    /// Whether voltages sag within their rows, and not by chance. How, only duties and the supply show.
    fn sags(&self, log: &Log) -> Option<&'static str> {
        let sags = self.value[6].abs() > 3.0 * self.deviation[6];
        (log.supply.is_none() && sags && !self.early()).then_some(
            "the voltages sag while currents rise, and by how much within a row only duties with the supply tell",
        )
    }

    /// These, with lags that turned out to be none.
    pub(super) fn but_for_lag(mut self, early: &Self) -> Self {
        self.value[..2].copy_from_slice(&early.value[..2]);
        self.deviation[..2].copy_from_slice(&early.deviation[..2]);
        self
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

    /// Why mass and friction may be uncertain: a loss or a band that was to be found and was not.
    pub(super) fn hidden(&self, quantile: f64) -> Option<&'static str> {
        let hidden = |i: usize| {
            self.before.0[i].deviation > EXACT && !self.shown(i, self.half_width(i, quantile))
        };
        if (2..4).any(hidden) {
            return Some(
                "the motors hardly ever braked the wheels, which alone shows the losses of their gears",
            );
        }
        (4..6)
            .any(hidden)
            .then_some("without currents a driver's dead band looks like friction")
    }

    /// Half of the interval.
    fn half_width(&self, i: usize, quantile: f64) -> f64 {
        quantile * self.deviation[i]
    }

    fn shown(&self, i: usize, half_width: f64) -> bool {
        half_width <= SHOWN * self.before.0[i].deviation
    }

    /// Those that the log shows better than what was known before, by half at least.
    pub(super) fn entries(&self, quantile: f64) -> Vec<Entry> {
        let one = |i: usize| {
            let half_width = self.half_width(i, quantile);
            if self.before.0[i].deviation <= EXACT || !self.shown(i, half_width) {
                return None;
            }
            let (name, unit, meaning, value) = match i / 2 {
                0 if self.early() || self.largest_lag_s.is_none() => return None,
                0 => (
                    "lag",
                    "s",
                    "from command to torque: winding and driver",
                    self.value[i],
                ),
                1 => (
                    "efficiency",
                    "1",
                    "share of the motor's torque that its gear lets through",
                    1.0 - self.value[i],
                ),
                _ => (
                    "dead_band",
                    "1",
                    "share of full duty that is lost at either sign",
                    self.value[i],
                ),
            };
            let verdict = Verdict::Identified { value, half_width };
            Some(Entry::new(
                &format!("{name}_{}", SIDES[i % 2]),
                unit,
                meaning,
                verdict,
            ))
        };
        (0..6).filter_map(one).collect()
    }
}
