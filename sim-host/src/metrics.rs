//! Figures of merit of a run. Times in s, lengths in m, angles in rad; errors are the true ones.

use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::maths::{Libm, Maths};
use controller_core::pose_error::PoseError;
use serde::Serialize;

/// The paper's errors are "corrected" once |(e_x, e_y, e_θ)| stays below this (5 cm, 0.05 rad).
pub const SETTLED: f64 = 0.05;
/// The robot is parked once |(e_x, e_y, e_θ)| stays below this (1 cm, 0.01 rad).
pub const PARKED: f64 = 0.01;

/// A pose error and its norms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseFigures {
    /// |(e_x, e_y, e_θ)|, metres and radians weighed alike.
    pub norm: f64,
    /// |(e_x, e_y)|.
    pub position_m: f64,
    /// e_x.
    pub e_x_m: f64,
    /// e_y.
    pub e_y_m: f64,
    /// e_θ.
    pub e_theta_rad: f64,
}

/// How large a signal gets, and how far it moves from one tick to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Extremes {
    /// Largest magnitude.
    pub peak: f64,
    /// Largest magnitude of the change over one tick. For forces, moments and torques the step
    /// from zero at the start counts.
    pub largest_change_per_tick: f64,
}

/// Force and moment that appear between two instants that are one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WrenchStep {
    /// Of the force.
    pub force_n: f64,
    /// Of the moment.
    pub moment_nm: f64,
}

/// What changed at the hand-over, and what came of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HandOverFigures {
    /// When.
    pub time_s: f64,
    /// With respect to the virtual target point, q_r(P).
    pub error_before: PoseFigures,
    /// With respect to the target: the pulse.
    pub error_after: PoseFigures,
    /// New law minus old law, at the same instant.
    pub torque_step: WrenchStep,
    /// From the hand-over until the error stays below [`PARKED`]; none if it never does.
    pub parked_after_s: Option<f64>,
    /// How far past the target, along the target's heading, the robot goes.
    pub overshoot_m: f64,
}

/// All figures of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// First time from which the error stays below [`SETTLED`] to the hand-over, or to the end of a
    /// run without one; none if it never does.
    pub settling_s: Option<f64>,
    /// What happened at the hand-over.
    pub hand_over: Option<HandOverFigures>,
    /// At the last tick.
    pub final_error: PoseFigures,
    /// v.
    pub speed_m_s: Extremes,
    /// w.
    pub turn_rate_rad_s: Extremes,
    /// τ₁, as the law demands it.
    pub force_n: Extremes,
    /// τ₂, as the law demands it.
    pub moment_nm: Extremes,
    /// τ_right, as it acts.
    pub torque_right_nm: Extremes,
    /// τ_left, as it acts.
    pub torque_left_nm: Extremes,
    /// τ at t = 0: the step from a robot without torque.
    pub start_torque_step: WrenchStep,
    /// Ticks in which torques were scaled down to the limit.
    pub saturated_ticks: usize,
    /// Ticks in which a transition offset was at work.
    pub bridged_ticks: usize,
}

impl PoseFigures {
    fn of(error: &PoseError<f64>) -> Self {
        Self {
            norm: error.norm::<Libm>(),
            position_m: Libm::sqrt(error.x * error.x + error.y * error.y),
            e_x_m: error.x,
            e_y_m: error.y,
            e_theta_rad: error.theta,
        }
    }
}

impl Extremes {
    /// Of `signal`, which is at `before` ahead of the first row.
    fn of(rows: &[TraceRow], before: Option<f64>, signal: impl Fn(&TraceRow) -> f64) -> Self {
        let mut extremes = Self::default();
        let mut last = before;
        for row in rows {
            let value = signal(row);
            let change = last.map_or(0.0, |last| (value - last).abs());
            extremes.peak = extremes.peak.max(value.abs());
            extremes.largest_change_per_tick = extremes.largest_change_per_tick.max(change);
            last = Some(value);
        }
        extremes
    }
}

impl Metrics {
    /// The figures of a trace; none if it has no rows.
    pub fn of(trace: &Trace) -> Option<Self> {
        let rows = &trace.rows;
        let (first, last) = (rows.first()?, rows.last()?);
        let wrench = first.report.wrench;
        Some(Self {
            settling_s: settling(trace),
            hand_over: trace
                .parking()
                .map(|hand_over| at_hand_over(rows, &hand_over)),
            final_error: PoseFigures::of(&last.error),
            speed_m_s: Extremes::of(rows, None, |row| row.truth.twist.linear),
            turn_rate_rad_s: Extremes::of(rows, None, |row| row.truth.twist.angular),
            force_n: Extremes::of(rows, Some(0.0), |row| row.report.wrench.force),
            moment_nm: Extremes::of(rows, Some(0.0), |row| row.report.wrench.moment),
            torque_right_nm: Extremes::of(rows, Some(0.0), |row| row.report.torques.right),
            torque_left_nm: Extremes::of(rows, Some(0.0), |row| row.report.torques.left),
            start_torque_step: WrenchStep {
                force_n: wrench.force,
                moment_nm: wrench.moment,
            },
            saturated_ticks: count(rows, |row| row.report.limited.torque),
            bridged_ticks: count(rows, TraceRow::has_transition_offset),
        })
    }
}

fn count(rows: &[TraceRow], condition: impl Fn(&TraceRow) -> bool) -> usize {
    rows.iter().filter(|row| condition(row)).count()
}

/// The first index from which all of `norms` are below `limit`; none if the last one is not.
fn stays_below(
    norms: impl DoubleEndedIterator<Item = f64> + ExactSizeIterator,
    limit: f64,
) -> Option<usize> {
    let length = norms.len();
    // `!(<)` and not `>=`: a norm that is not a number has not settled.
    let inside = norms.rev().take_while(|norm| *norm < limit).count();
    (inside > 0).then(|| length - inside)
}

fn settling(trace: &Trace) -> Option<f64> {
    let rows = &trace.rows;
    let norm = |row: &TraceRow| row.error.norm::<Libm>();
    let index = match trace.parking() {
        None => stays_below(rows.iter().map(norm), SETTLED)?,
        Some(hand_over) => {
            if hand_over.error_before.norm::<Libm>() >= SETTLED {
                return None;
            }
            let tracked = &rows[..hand_over.row];
            // Settled in the very tick of the hand-over is settled there.
            stays_below(tracked.iter().map(norm), SETTLED).unwrap_or(hand_over.row)
        }
    };
    Some(rows[index].t)
}

fn at_hand_over(rows: &[TraceRow], hand_over: &HandOver) -> HandOverFigures {
    let parking = &rows[hand_over.row..];
    let row = &parking[0];
    let norms = parking.iter().map(|row| row.error.norm::<Libm>());
    let step = hand_over.torque_step;
    HandOverFigures {
        time_s: row.t,
        error_before: PoseFigures::of(&hand_over.error_before),
        error_after: PoseFigures::of(&row.error),
        torque_step: WrenchStep {
            force_n: step.force,
            moment_nm: step.moment,
        },
        parked_after_s: stays_below(norms, PARKED).map(|index| parking[index].t - row.t),
        overshoot_m: overshoot(parking, hand_over),
    }
}

/// Along the target's heading, on the side that the robot does not come from.
fn overshoot(parking: &[TraceRow], hand_over: &HandOver) -> f64 {
    let goal = hand_over.goal;
    let (sine, cosine) = Libm::sin_cos(goal.theta);
    let to_go = |row: &TraceRow| {
        let pose = row.truth.pose;
        (goal.x - pose.x) * cosine + (goal.y - pose.y) * sine
    };
    let side = if to_go(&parking[0]) < 0.0 { -1.0 } else { 1.0 };
    let past = |row: &TraceRow| -side * to_go(row);
    parking.iter().map(past).fold(0.0, f64::max)
}
