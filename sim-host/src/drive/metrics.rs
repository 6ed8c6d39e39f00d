//! Figures of merit of a run. Times in s, lengths in m, angles in rad; errors are the true ones.

use crate::csv_out::outcome_name;
use crate::metrics::Metrics;
use crate::mission::{Course, Mission};
use crate::names::{self, Name};
use crate::trace::{Trace, TraceRow, cause, state_name};
use controller_core::angle::wrap;
use controller_core::maths::{Libm, Maths};
use controller_core::motion::{Mode, Outcome};
use serde::{Deserialize, Serialize};

/// The robot is on the path once its position and heading errors have been below these \[m, rad\].
pub const ON_PATH: (f64, f64) = (5.0e-3, 0.1);
/// A moment below this does not count when changes of its sign are counted \[N m\].
const NO_MOMENT: f64 = 1.0e-3;

/// Position and heading errors while following.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TrackingFigures {
    /// The first tick with errors below 5 mm and 0.1 rad; all later ones count. After an event that
    /// took the robot off the route: since it came back to it.
    pub from_s: f64,
    /// Hand-over, or end.
    pub to_s: f64,
    /// Position, root of the mean square.
    pub rms_m: f64,
    /// Position, largest.
    pub peak_m: f64,
    /// Heading, root of the mean square.
    pub heading_rms_rad: f64,
    /// Heading, largest.
    pub heading_peak_rad: f64,
}

/// The largest value of something that is limited.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LimitUse {
    /// With its unit.
    pub name: &'static str,
    /// Largest magnitude in the run.
    pub peak: f64,
    /// The limit.
    pub limit: f64,
}

/// Ticks in which limits were at work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LimitedTicks {
    /// Speed or turn rate.
    pub speed: usize,
    /// Acceleration.
    pub accel: usize,
    /// Jerk.
    pub jerk: usize,
    /// Wheel torque.
    pub torque: usize,
}

/// Why a base did not go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopFigures {
    /// When it began to stop \[s\].
    pub time_s: f64,
    /// Its state at the end: `stopped`, `fault`, or still on the way to either.
    #[serde(deserialize_with = "names::one")]
    pub state: Name,
    /// The fault, or what else it was.
    pub cause: String,
}

/// All figures of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DriveMetrics {
    /// `parked`, `driving`, `stalled` or `out-of-tolerance` at the end.
    pub outcome: &'static str,
    /// What ended the run before its time; only of a whole base.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<StopFigures>,
    /// From when on the robot was parked; none if it was not at the end.
    pub parked_s: Option<f64>,
    /// Whether there is a path to follow.
    #[serde(skip)]
    pub has_path: bool,
    /// While following; none if the robot never came onto the path.
    pub tracking: Option<TrackingFigures>,
    /// What the robot still had to go at the hand-over.
    pub hand_over_distance_m: Option<f64>,
    /// Changes of sign of the moment over the whole run.
    pub moment_sign_changes: usize,
    /// Peaks beside limits.
    pub limits: Vec<LimitUse>,
    /// Ticks in which limits were at work.
    pub limited_ticks: LimitedTicks,
    /// The figures of every scenario.
    pub run: Metrics,
}

impl DriveMetrics {
    /// The figures of a trace; none if it has no rows.
    pub fn of(mission: &Mission, trace: &Trace) -> Option<Self> {
        let rows = &trace.rows;
        let last = rows.last()?;
        let is_parked = |row: &&TraceRow| row.report.outcome == Outcome::Parked;
        let parked = rows.iter().rev().take_while(is_parked).last();
        let count = |limited: fn(&TraceRow) -> bool| rows.iter().filter(|r| limited(r)).count();
        Some(Self {
            outcome: outcome_name(last.report.outcome),
            stopped: stopped(trace),
            parked_s: parked.map(|row| row.t),
            has_path: matches!(mission.course, Course::Follow { .. }),
            tracking: tracking(trace),
            hand_over_distance_m: trace.hand_over.map(|h| h.distance_m),
            moment_sign_changes: sign_changes(rows),
            limits: limits(mission, rows),
            limited_ticks: LimitedTicks {
                speed: count(|row| row.report.limited.speed),
                accel: count(|row| row.report.limited.accel),
                jerk: count(|row| row.report.limited.jerk),
                torque: count(|row| row.report.limited.torque),
            },
            run: Metrics::of(trace)?,
        })
    }
}

/// The stop that a run ended with.
fn stopped(trace: &Trace) -> Option<StopFigures> {
    let first = trace.stop()?;
    let base = trace.rows.last()?.base?;
    Some(StopFigures {
        time_s: first.t,
        state: state_name(base.state),
        cause: cause(&base.cause),
    })
}

fn tracking(trace: &Trace) -> Option<TrackingFigures> {
    let end = trace.hand_over.map_or(trace.rows.len(), |h| h.row);
    let rows = trace.rows.get(..end)?;
    let leaves = |row: &TraceRow| row.report.mode != Mode::Following;
    let back = rows.iter().rposition(leaves).map_or(0, |last| last + 1);
    let rows = rows.get(back..)?;
    let distance = |row: &TraceRow| Libm::sqrt(row.error.x.powi(2) + row.error.y.powi(2));
    let on_path = rows
        .iter()
        .position(|row| distance(row) < ON_PATH.0 && row.error.theta.abs() < ON_PATH.1)?;
    let rows = rows.get(on_path..)?;
    let mut figures = TrackingFigures {
        from_s: rows.first()?.t,
        to_s: trace.rows.get(end).or(trace.rows.last())?.t,
        ..TrackingFigures::default()
    };
    let mut count = 0.0;
    for row in rows {
        let (off, turned) = (distance(row), wrap(row.error.theta).abs());
        count += 1.0;
        figures.rms_m += off * off;
        figures.peak_m = figures.peak_m.max(off);
        figures.heading_rms_rad += turned * turned;
        figures.heading_peak_rad = figures.heading_peak_rad.max(turned);
    }
    figures.rms_m = Libm::sqrt(figures.rms_m / count);
    figures.heading_rms_rad = Libm::sqrt(figures.heading_rms_rad / count);
    Some(figures)
}

fn sign_changes(rows: &[TraceRow]) -> usize {
    let moments = rows.iter().map(|row| row.report.wrench.moment);
    let mut last = 0.0;
    let mut changes = 0;
    for moment in moments.filter(|moment| moment.abs() > NO_MOMENT) {
        changes += usize::from(moment * last < 0.0);
        last = moment;
    }
    changes
}

fn limits(mission: &Mission, rows: &[TraceRow]) -> Vec<LimitUse> {
    let limits = &mission.base.limits;
    let peak = |name, limit, signal: &dyn Fn(&TraceRow) -> f64| LimitUse {
        name,
        peak: rows.iter().map(|row| signal(row).abs()).fold(0.0, f64::max),
        limit,
    };
    // Speeding up or braking, by the sign of the command.
    let along = |row: &TraceRow, up: bool| {
        let (speed, rate) = (row.report.command.linear, row.report.command_rate.linear);
        if (speed * rate >= 0.0) == up {
            rate
        } else {
            0.0
        }
    };
    vec![
        peak("commanded speed [m/s]", limits.speed, &|row| {
            row.report.command.linear
        }),
        peak("commanded turn rate [rad/s]", limits.turn_rate, &|row| {
            row.report.command.angular
        }),
        peak("acceleration [m/s2]", limits.accel, &|row| along(row, true)),
        peak("braking [m/s2]", limits.brake, &|row| along(row, false)),
        peak("angular acceleration [rad/s2]", limits.turn_accel, &|row| {
            row.report.command_rate.angular
        }),
        peak("right wheel [N m]", limits.wheel_torque_nm, &|row| {
            row.report.torques.right
        }),
        peak("left wheel [N m]", limits.wheel_torque_nm, &|row| {
            row.report.torques.left
        }),
    ]
}
