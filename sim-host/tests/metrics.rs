//! Figures of merit on traces made by hand.

use controller_core::maths::Libm;
use controller_core::motion::{Mode, MotionReport};
use controller_core::pose_error::PoseError;
use controller_core::reference::Reference;
use controller_core::types::{Measured, Pose, Twist, WheelTorques, Wrench};
use sim_host::metrics::Metrics;
use sim_host::trace::{HandOver, Trace, TraceRow};

/// A row of a robot on the x axis, `ahead` behind its reference.
fn row(tick: usize, x: f64, ahead: f64) -> TraceRow {
    let error = PoseError {
        x: ahead,
        y: 0.0,
        theta: 0.0,
    };
    TraceRow {
        t: tick as f64 * 0.1,
        truth: Measured {
            pose: Pose::new(x, 0.0, 0.0),
            twist: Twist::default(),
        },
        reference: Reference::at_rest_with::<Libm>(Pose::new(x + ahead, 0.0, 0.0)),
        error,
        measured: Pose::new(x, 0.0, 0.0),
        report: MotionReport {
            error,
            ..MotionReport::default()
        },
        paper: None,
        base: None,
    }
}

fn tracking(errors: &[f64]) -> Trace {
    Trace {
        period_s: 0.1,
        rows: errors
            .iter()
            .enumerate()
            .map(|(i, e)| row(i, 0.0, *e))
            .collect(),
        hand_over: None,
    }
}

fn metrics(trace: &Trace) -> Metrics {
    Metrics::of(trace).expect("rows")
}

#[test]
fn settling_counts_from_the_last_time_outside() {
    let trace = tracking(&[1.0, 0.04, 0.06, 0.04, 0.03, 0.0]);
    assert_eq!(metrics(&trace).settling_s, Some(trace.rows[3].t));
    // On the limit is outside.
    assert_eq!(metrics(&tracking(&[0.05, 0.05])).settling_s, None);
    assert_eq!(metrics(&tracking(&[0.0, 0.04])).settling_s, Some(0.0));
    assert_eq!(metrics(&tracking(&[0.0, f64::NAN])).settling_s, None);
}

#[test]
fn a_trace_without_rows_has_no_figures() {
    assert_eq!(Metrics::of(&Trace::default()), None);
}

/// Tracks with `before`, hands over 1 m short of the target, then stands at `x`.
fn parking(before: &[f64], at_switch: f64, x: &[f64]) -> Trace {
    let goal = Pose::new(1.0, 0.0, 0.0);
    let mut trace = tracking(before);
    let first = trace.rows.len();
    for (i, x) in x.iter().enumerate() {
        let mut row = row(first + i, *x, goal.x - x);
        row.report.mode = Mode::Parking;
        trace.rows.push(row);
    }
    trace.hand_over = Some(HandOver {
        row: first,
        left: Reference::at_rest_with::<Libm>(Pose::new(at_switch, 0.0, 0.0)),
        goal,
        distance_m: 1.0,
        error_before: PoseError {
            x: at_switch,
            y: 0.0,
            theta: 0.0,
        },
        torque_step: Wrench {
            force: -3.0,
            moment: 2.0,
        },
    });
    trace
}

#[test]
fn the_pulse_of_the_hand_over_does_not_unsettle() {
    let trace = parking(&[1.0, 0.04, 0.04], 0.01, &[0.0, 0.5, 1.0, 1.02, 1.009, 1.0]);
    let metrics = metrics(&trace);
    assert_eq!(metrics.settling_s, Some(trace.rows[1].t));
    let hand_over = metrics.hand_over.expect("handed over");
    assert_eq!(hand_over.time_s, trace.rows[3].t);
    assert_eq!(hand_over.error_before.norm, 0.01);
    assert_eq!(
        (hand_over.error_after.e_x_m, hand_over.error_after.norm),
        (1.0, 1.0)
    );
    assert_eq!(
        (
            hand_over.torque_step.force_n,
            hand_over.torque_step.moment_nm
        ),
        (-3.0, 2.0)
    );
    assert!((hand_over.overshoot_m - 0.02).abs() < 1e-15);
    // 9 mm past the target is parked, 20 mm was not.
    assert_eq!(
        hand_over.parked_after_s,
        Some(trace.rows[7].t - trace.rows[3].t)
    );
    assert_eq!(metrics.final_error.norm, 0.0);
}

#[test]
fn an_error_at_the_very_hand_over_counts() {
    assert_eq!(
        metrics(&parking(&[0.01, 0.01], 0.06, &[0.9, 1.0])).settling_s,
        None
    );
    let late = parking(&[1.0, 0.06], 0.04, &[0.9, 1.0]);
    assert_eq!(metrics(&late).settling_s, Some(late.rows[2].t));
}

#[test]
fn a_robot_that_backs_to_its_target_overshoots_backwards() {
    let trace = parking(&[0.0], 0.0, &[2.0, 1.5, 0.97, 1.0]);
    let hand_over = metrics(&trace).hand_over.expect("handed over");
    assert!((hand_over.overshoot_m - 0.03).abs() < 1e-15);
}

#[test]
fn the_step_from_rest_counts_for_torques_and_not_for_speeds() {
    let mut trace = tracking(&[0.0, 0.0, 0.0]);
    for (row, value) in trace.rows.iter_mut().zip([-5.0, -1.0, 2.0]) {
        row.report.wrench = Wrench {
            force: value,
            moment: 0.5 * value,
        };
        row.report.torques = WheelTorques {
            right: 0.1 * value,
            left: 0.2 * value,
        };
        row.truth.twist = Twist::new(value, 2.0 * value);
    }
    let metrics = metrics(&trace);
    assert_eq!(
        (
            metrics.force_n.peak,
            metrics.force_n.largest_change_per_tick
        ),
        (5.0, 5.0)
    );
    assert_eq!(metrics.moment_nm.largest_change_per_tick, 2.5);
    assert_eq!(metrics.torque_left_nm.largest_change_per_tick, 1.0);
    assert_eq!(
        (
            metrics.speed_m_s.peak,
            metrics.speed_m_s.largest_change_per_tick
        ),
        (5.0, 4.0)
    );
    assert_eq!(metrics.turn_rate_rad_s.largest_change_per_tick, 8.0);
    assert_eq!(
        (
            metrics.start_torque_step.force_n,
            metrics.start_torque_step.moment_nm
        ),
        (-5.0, -2.5)
    );
}
