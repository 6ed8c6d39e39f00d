//! What came of a trial. True errors, SI units.

use crate::drive::{DriveMetrics, StopFigures};
use crate::mission::Mission;
use crate::names::{self, Name};
use crate::trace::{Trace, TraceRow};
use controller_core::maths::{Libm, Maths};
use controller_core::safety::FaultKind;
use controller_core::safety::supervisor::State;
use serde::{Deserialize, Serialize};

/// How long a base is watched at rest \[s\].
pub const REST_S: f64 = 3.0;
/// What of that is its coming to rest: stopping takes less than a second.
const SETTLE_S: f64 = 1.0;

/// The largest use of any limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Of what, with its unit.
    #[serde(deserialize_with = "names::one")]
    pub name: Name,
    /// Peak over limit.
    pub share: f64,
}

/// Figures of one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Parked at the end, and for all of [`REST_S`].
    pub parked: bool,
    /// When it parked; if it did not, when the run ended \[s\].
    pub time_s: f64,
    /// Distance to the goal at the end \[m\].
    pub error_m: f64,
    /// Heading error at the end \[rad\].
    pub error_rad: f64,
    /// Root of the mean square distance to the reference, once on it \[m\]; none if never or while parking.
    pub tracking_m: Option<f64>,
    /// Largest minus least torque asked of the worse wheel at rest, over its limit; none unless parked.
    pub ripple: Option<f64>,
    /// Root of the mean square torque of the worse wheel over its limit.
    pub effort: f64,
    /// The largest use of a limit.
    pub peak: Option<Peak>,
    /// What it stopped for, if it did.
    pub stopped: Option<StopFigures>,
    /// Names of faults that were found, ignored or not.
    #[serde(deserialize_with = "names::list")]
    pub found: Vec<&'static str>,
}

impl Figures {
    /// The figures of a trace.
    pub fn of(mission: &Mission, trace: &Trace) -> Self {
        let rows = &trace.rows;
        let limit = mission.base.limits.wheel_torque_nm;
        let metrics = DriveMetrics::of(mission, trace);
        let end_s = rows.last().map_or(0.0, |row| row.t);
        let rests = |row: &&TraceRow| row.base.is_some_and(|b| b.state == State::Parked);
        let resting = rows.iter().rev().take_while(rests).count();
        let rest = rows.get(rows.len() - resting..).unwrap_or_default();
        let since_s = rest.first().map_or(end_s, |row| row.t);
        // A tick of slack: time is a sum of uneven ticks.
        let parked = !rest.is_empty() && end_s - since_s >= REST_S - 2.0 * trace.period_s;
        let quiet = rest.iter().filter(|row| row.t >= since_s + SETTLE_S);
        let last = metrics.as_ref().map(|m| m.run.final_error);
        let used = metrics.as_ref().map(|m| m.limits.iter());
        let shares = used.into_iter().flatten().map(|used| Peak {
            name: used.name,
            share: used.peak / used.limit,
        });
        let faults = FaultKind::ALL.iter().filter(|kind| {
            let mut notes = rows.iter().filter_map(|row| row.base);
            notes.any(|base| base.active_faults.get(**kind).is_some())
        });
        Self {
            parked,
            time_s: since_s,
            error_m: last.map_or(f64::INFINITY, |e| e.position_m),
            error_rad: last.map_or(f64::INFINITY, |e| e.e_theta_rad.abs()),
            tracking_m: metrics.as_ref().and_then(|m| m.tracking).map(|t| t.rms_m),
            ripple: parked.then(|| worse(quiet, spread) / limit),
            effort: worse(rows.iter(), root_mean_square) / limit,
            peak: shares.reduce(|a, b| if b.share > a.share { b } else { a }),
            found: faults.map(|kind| kind.name()).collect(),
            stopped: metrics.and_then(|m| m.stopped),
        }
    }
}

/// A figure of the torques asked of each wheel: the larger one.
fn worse<'a>(rows: impl Iterator<Item = &'a TraceRow>, figure: fn(&[f64]) -> f64) -> f64 {
    let asked = rows.filter_map(|row| row.base).map(|base| base.asked);
    let (right, left): (Vec<f64>, Vec<f64>) = asked.map(|t| (t.right, t.left)).unzip();
    figure(&right).max(figure(&left))
}

fn root_mean_square(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    Libm::sqrt(values.iter().map(|v| v * v).sum::<f64>() / count)
}

/// Largest minus least.
fn spread(values: &[f64]) -> f64 {
    let most = values.iter().copied().reduce(f64::max);
    let least = values.iter().copied().reduce(f64::min);
    most.zip(least).map_or(0.0, |(most, least)| most - least)
}
