//! What came of a run. True errors, SI units.

use super::ARRIVED;
use crate::drive::DriveMetrics;
use crate::mission::{Course, Mission};
use crate::trace::{Trace, TraceRow};
use controller_core::angle::wrap;
use controller_core::maths::{Libm, Maths};
use controller_core::motion::Outcome;
use controller_core::safety::supervisor::State;
use controller_core::types::{Pose, WheelTorques};

/// Figures of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// From when on truly within [`ARRIVED`] of the goal, for good; none if not at the end \[s\].
    pub arrived_s: Option<f64>,
    /// From when on it says that it is parked \[s\].
    pub parked_s: Option<f64>,
    /// Distance to the goal at the end \[m\].
    pub error_m: f64,
    /// Heading error at the end \[rad\].
    pub error_rad: f64,
    /// Root of the mean square distance to the reference, once on it \[m\]; of velocity orders the speed of a rim beside
    /// the ordered one \[m/s\].
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
            .is_some_and(|base| matches!(base.state, State::Stopped | State::Fault));
        let tracking = DriveMetrics::of(mission, trace).and_then(|metrics| metrics.tracking);
        Self {
            arrived_s: since.map(|row| row.t),
            parked_s: parked.map(|row| row.t),
            error_m,
            error_rad,
            rms_m: tracking.map(|tracking| tracking.rms_m),
            peak_m: tracking.map(|tracking| tracking.peak_m),
            torque_step: torque_step(mission, rows),
            jerk: jerk(mission, trace),
            energy_j: energy(mission, trace),
            failed: since.is_none() || stopped,
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

/// What was asked of the wheels.
fn asked(row: &TraceRow) -> WheelTorques<f64> {
    row.base.map_or(row.report.torques, |base| base.asked)
}

fn torque_step(mission: &Mission, rows: &[TraceRow]) -> f64 {
    let limit = mission.base.limits.wheel_torque_nm;
    let steps = rows.windows(2).filter_map(|pair| {
        let [from, to] = pair else { return None };
        let (from, to) = (asked(from), asked(to));
        Some((to.right - from.right).abs().max((to.left - from.left).abs()))
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
