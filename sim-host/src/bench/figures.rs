//! What came of a run. True errors, SI units.

use super::ARRIVED;
use crate::drive::DriveMetrics;
use crate::mission::{Change, Course, Mission, VelocityOrder};
use crate::trace::{Trace, TraceRow, cause};
use controller_core::angle::wrap;
use controller_core::maths::{Libm, Maths};
use controller_core::motion::Outcome;
use controller_core::safety::supervisor::State;
use controller_core::types::{Pose, WheelTorques};

/// Figures of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// From when on truly within [`ARRIVED`] of the goal, for good; none if not at the end \[s\]. Of velocity orders the sum
    /// of the times until each was truly driven, up to [`DRIVEN`]; none if one never was.
    pub arrived_s: Option<f64>,
    /// From when on it says that it is parked \[s\].
    pub parked_s: Option<f64>,
    /// Distance to the goal at the end \[m\].
    pub error_m: f64,
    /// Heading error at the end \[rad\].
    pub error_rad: f64,
    /// Root of the mean square distance to the reference, once on it \[m\]; of velocity orders the speed of a rim beside
    /// the ordered one, once driven \[m/s\].
    pub rms_m: Option<f64>,
    /// The largest of these.
    pub peak_m: Option<f64>,
    /// Largest change of the torque asked of a wheel from tick to tick, over the wheel's limit.
    pub torque_step: f64,
    /// Root of the mean square jerk of a rim \[m/s³\].
    pub jerk: f64,
    /// Work of the wheels where they drive \[J\].
    pub energy_j: f64,
    /// It did not arrive, or stopped for a fault.
    pub failed: bool,
    /// What it stopped for.
    pub stopped: Option<String>,
}

impl Figures {
    /// A law that had no answer, or refused.
    pub fn refused() -> Self {
        Self {
            error_m: f64::INFINITY,
            error_rad: f64::INFINITY,
            failed: true,
            ..Self::default()
        }
    }

    /// The figures of a trace.
    pub fn of(mission: &Mission, trace: &Trace) -> Self {
        let rows = &trace.rows;
        let Some(last) = rows.last() else {
            return Self::refused();
        };
        let drives = matches!(mission.course, Course::Drive);
        let goal = goal(mission, last);
        let inside = |row: &&TraceRow| {
            let (distance, heading) = off(&goal, &row.truth.pose);
            distance <= ARRIVED.0 && heading <= ARRIVED.1
        };
        let since = rows.iter().rev().take_while(inside).last();
        let is_parked = |row: &&TraceRow| {
            row.report.outcome == Outcome::Parked
                || row.base.is_some_and(|base| base.state == State::Parked)
        };
        let parked = rows.iter().rev().take_while(is_parked).last();
        let (error_m, error_rad) = off(&goal, &last.truth.pose);
        let stopped = last
            .base
            .filter(|base| matches!(base.state, State::Stopped | State::Fault))
            .map(|base| cause(&base.cause));
        let (arrived_s, off) = if drives {
            let (driven_s, off) = driven(mission, rows);
            (driven_s.filter(|_| stopped.is_none()), off)
        } else {
            let follows = matches!(mission.course, Course::Follow { .. });
            let metrics = follows.then(|| DriveMetrics::of(mission, trace)).flatten();
            let tracking = metrics.and_then(|metrics| metrics.tracking);
            let off = tracking.map(|tracking| (tracking.rms_m, tracking.peak_m));
            (since.map(|row| row.t), off)
        };
        Self {
            arrived_s,
            parked_s: parked.map(|row| row.t),
            error_m: if drives { 0.0 } else { error_m },
            error_rad: if drives { 0.0 } else { error_rad },
            rms_m: off.map(|(rms, _)| rms),
            peak_m: off.map(|(_, peak)| peak),
            torque_step: torque_step(mission, rows),
            jerk: jerk(mission, trace),
            energy_j: energy(mission, trace),
            failed: arrived_s.is_none() || stopped.is_some(),
            stopped,
        }
    }
}

/// Where a run has to end.
fn goal(mission: &Mission, last: &TraceRow) -> Pose<f64> {
    match &mission.course {
        Course::Park(goal) => *goal,
        Course::Follow {
            hand_over: Some(rule),
            ..
        } => rule.goal,
        Course::Follow { .. } | Course::Drive => *last.reference.pose(),
    }
}

/// Distance and heading error.
fn off(goal: &Pose<f64>, pose: &Pose<f64>) -> (f64, f64) {
    let (dx, dy) = (goal.x - pose.x, goal.y - pose.y);
    (
        Libm::sqrt(dx * dx + dy * dy),
        wrap(goal.theta - pose.theta).abs(),
    )
}

/// An order is driven within this share of the largest speed and of the largest turn rate.
pub const DRIVEN: f64 = 0.02;

/// The sum of the times until each order was driven for good, and how far the rims were off from then on: root of the
/// mean square, and largest \[m/s\].
fn driven(mission: &Mission, rows: &[TraceRow]) -> (Option<f64>, Option<(f64, f64)>) {
    let limits = &mission.base.limits;
    let lever = 0.5 * mission.base.robot.wheels.track_m;
    let (mut sum, mut squares, mut count, mut peak) = (Some(0.0), 0.0, 0.0, 0.0_f64);
    for (at, event) in mission.events.iter().enumerate() {
        let Change::Drive(VelocityOrder { twist, .. }) = event.change else {
            continue;
        };
        let end = mission
            .events
            .get(at + 1)
            .map_or(f64::INFINITY, |next| next.at_s);
        let own = rows.iter().filter(|row| row.t >= event.at_s && row.t < end);
        let off = |row: &TraceRow| {
            let (v, w) = (row.truth.twist.linear, row.truth.twist.angular);
            ((v - twist.linear).abs(), (w - twist.angular).abs())
        };
        let is_driven = |row: &TraceRow| {
            let (along, about) = off(row);
            along <= DRIVEN * limits.speed && about <= DRIVEN * limits.turn_rate
        };
        let own: Vec<&TraceRow> = own.collect();
        let late = own
            .iter()
            .rposition(|row| !is_driven(row))
            .map_or(0, |last| last + 1);
        let settled = own.get(late..).unwrap_or_default();
        sum = sum
            .zip(settled.first())
            .map(|(sum, row)| sum + row.t - event.at_s);
        for row in settled {
            let (along, about) = off(row);
            let rim = along + lever * about;
            squares += rim * rim;
            count += 1.0;
            peak = peak.max(rim);
        }
    }
    let off = (count > 0.0).then(|| (Libm::sqrt(squares / count), peak));
    (sum, off)
}

/// What was asked of the wheels.
fn asked(row: &TraceRow) -> WheelTorques<f64> {
    row.base.map_or(row.report.torques, |base| base.asked)
}

fn torque_step(mission: &Mission, rows: &[TraceRow]) -> f64 {
    let limit = mission.base.limits.wheel_torque_nm;
    let steps = rows.windows(2).filter_map(|pair| {
        let [from, to] = pair else { return None };
        let (from, to) = (asked(from), asked(to));
        Some(
            (to.right - from.right)
                .abs()
                .max((to.left - from.left).abs()),
        )
    });
    steps.fold(0.0, f64::max) / limit
}

/// Speeds of the right and the left rim.
fn rims(mission: &Mission, row: &TraceRow) -> [f64; 2] {
    let lever = 0.5 * mission.base.robot.wheels.track_m;
    let twist = &row.truth.twist;
    [1.0, -1.0].map(|side| twist.linear + side * lever * twist.angular)
}

fn jerk(mission: &Mission, trace: &Trace) -> f64 {
    let dt = trace.period_s;
    let (mut sum, mut count) = (0.0, 0.0);
    for rows in trace.rows.windows(3) {
        let [a, b, c] = rows else { continue };
        let (a, b, c) = (rims(mission, a), rims(mission, b), rims(mission, c));
        for side in 0..2 {
            let jerk = (c[side] - 2.0 * b[side] + a[side]) / (dt * dt);
            sum += jerk * jerk;
            count += 1.0;
        }
    }
    if count > 0.0 {
        Libm::sqrt(sum / count)
    } else {
        0.0
    }
}

fn energy(mission: &Mission, trace: &Trace) -> f64 {
    let wheels = &mission.base.robot.wheels;
    let radii = [wheels.radius_right_m, wheels.radius_left_m];
    let mut work = 0.0;
    for pair in trace.rows.windows(2) {
        let [from, to] = pair else { continue };
        let torques = asked(from);
        let (begin, end) = (rims(mission, from), rims(mission, to));
        for (side, torque) in [torques.right, torques.left].into_iter().enumerate() {
            let way = 0.5 * (begin[side] + end[side]) * (to.t - from.t);
            work += (torque / radii[side] * way).max(0.0);
        }
    }
    work
}
