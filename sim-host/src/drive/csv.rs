//! Traces as CSV: full precision, one row per control tick.

use super::note::{cause, fix_name, state_name};
use super::trace::{DriveRow, DriveTrace};
use crate::csv_out::{write_numbers, written};
use controller_core::motion::{Mode, Outcome};
use std::io::Write;

/// The columns, in order. SI units, radians.
///
/// * x … w: the robot as it truly is; x_m … theta_m: the pose that the controller got.
/// * x_r … wdot_r: the reference (acceleration half a tick ahead); while parking the goal.
/// * e_x … e_theta: the error that the controller computed; v_d … wdot_d: what its pose law wants.
/// * b_v, b_w: what past jumps still add; v_c … wdot_c: the command, within all limits.
/// * d_v, d_w: measured minus commanded twist.
/// * dist1, dist2: estimated force \[N\] and moment \[N m\] beside the wheels.
/// * tau1, tau2: force \[N\] and moment \[N m\] asked for; tau_right, tau_left: what acts until the
///   next row.
/// * mode: `following` or `parking`; outcome: `driving`, `parked`, `stalled` or `out-of-tolerance`; then flags, 0 or 1,
///   and how often the robot tried the goal again.
/// * state, cause: of the whole base, and what became of an external pose in this tick: `fused`, `rejected`,
///   `relocalised`, `refused`. Empty on the ideal plant.
pub const COLUMNS: [&str; 51] = [
    "t",
    "x",
    "y",
    "theta",
    "v",
    "w",
    "x_m",
    "y_m",
    "theta_m",
    "x_r",
    "y_r",
    "theta_r",
    "v_r",
    "w_r",
    "vdot_r",
    "wdot_r",
    "e_x",
    "e_y",
    "e_theta",
    "v_d",
    "w_d",
    "vdot_d",
    "wdot_d",
    "b_v",
    "b_w",
    "v_c",
    "w_c",
    "vdot_c",
    "wdot_c",
    "d_v",
    "d_w",
    "dist1",
    "dist2",
    "tau1",
    "tau2",
    "tau_right",
    "tau_left",
    "mode",
    "outcome",
    "speed_limited",
    "accel_limited",
    "jerk_limited",
    "torque_limited",
    "disturbance_limited",
    "jumped",
    "backing",
    "retries",
    "tick",
    "state",
    "cause",
    "fix",
];

/// Writes a trace: the first row, every `every`-th after it, and always the hand-over and the last.
///
/// # Errors
/// Those of the writer.
pub fn write(trace: &DriveTrace, every: usize, out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    let hand_over = trace.hand_over.map(|hand_over| hand_over.row);
    for tick in written(trace.rows.len(), every, hand_over) {
        let row = &trace.rows[tick];
        write_numbers(&mut writer, numbers(row))?;
        let report = &row.report;
        writer.write_field(match report.mode {
            Mode::Following => "following",
            Mode::Parking => "parking",
        })?;
        writer.write_field(match report.outcome {
            Outcome::Parked => "parked",
            Outcome::Stalled => "stalled",
            Outcome::OutOfTolerance => "out-of-tolerance",
            _ => "driving",
        })?;
        let limited = &report.limited;
        for flag in [
            limited.speed,
            limited.accel,
            limited.jerk,
            limited.torque,
            limited.disturbance,
            report.jumped,
            report.backing,
        ] {
            writer.write_field(if flag { "1" } else { "0" })?;
        }
        writer.write_field(report.retries.to_string())?;
        writer.write_field(tick.to_string())?;
        let [state, cause, fix] = row.base.map_or_else(Default::default, |base| {
            let fix = fix_name(&base.fix).to_owned();
            [state_name(base.state).to_owned(), cause(&base.cause), fix]
        });
        for field in [state, cause, fix] {
            writer.write_field(field)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    Ok(())
}

fn numbers(row: &DriveRow) -> [f64; 37] {
    let (pose, twist, got) = (row.truth.pose, row.truth.twist, row.measured);
    let (at, moves, rates) = (
        row.reference.pose(),
        row.reference.twist(),
        row.reference.accel(),
    );
    let report = &row.report;
    [
        row.t,
        pose.x,
        pose.y,
        pose.theta,
        twist.linear,
        twist.angular,
        got.x,
        got.y,
        got.theta,
        at.x,
        at.y,
        at.theta,
        moves.linear,
        moves.angular,
        rates.linear,
        rates.angular,
        report.error.x,
        report.error.y,
        report.error.theta,
        report.desired.linear,
        report.desired.angular,
        report.desired_rate.linear,
        report.desired_rate.angular,
        report.transition_offset.linear,
        report.transition_offset.angular,
        report.command.linear,
        report.command.angular,
        report.command_rate.linear,
        report.command_rate.angular,
        report.velocity_error.linear,
        report.velocity_error.angular,
        report.disturbance.force,
        report.disturbance.moment,
        report.wrench.force,
        report.wrench.moment,
        report.torques.right,
        report.torques.left,
    ]
}
