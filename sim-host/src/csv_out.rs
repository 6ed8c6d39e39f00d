//! Traces as CSV: full precision, one row per control tick.

use crate::trace::{Trace, TraceRow};
use controller_core::paper::report::Phase;
use std::io::Write;

/// The columns, in order. SI units, radians.
///
/// * x … w: the robot as it truly is.
/// * x_r … w_r: the moving reference; from the hand-over on the resting target.
/// * e_x … wdot_c: what the controller computed; states without a part in the phase are 0.
/// * b_v, b_w: transition offsets within v_c and w_c.
/// * tau1, tau2: force \[N\] and moment \[N m\] that the law demands.
/// * tau_right, tau_left: what acts on the wheels until the next row.
/// * phase: `tracking` or `parking`; then flags, 0 or 1.
pub const COLUMNS: [&str; 37] = [
    "t",
    "x",
    "y",
    "theta",
    "v",
    "w",
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
    "s1",
    "s2",
    "s3",
    "vdot_s",
    "wdot_s",
    "v_c",
    "w_c",
    "vdot_c",
    "wdot_c",
    "b_v",
    "b_w",
    "tau1",
    "tau2",
    "tau_right",
    "tau_left",
    "phase",
    "handed_over",
    "bridging",
    "relaxing",
    "saturated",
    "tick",
];

/// Which of `rows` rows are written: the first, every `every`-th after it, and always the hand-over
/// and the last.
pub(crate) fn written(
    rows: usize,
    every: usize,
    hand_over: Option<usize>,
) -> impl Iterator<Item = usize> {
    let last = rows.saturating_sub(1);
    (0..rows).filter(move |&row| row % every.max(1) == 0 || row == last || Some(row) == hand_over)
}

/// Writes numbers as fields. `Display` of a double is the shortest text that reads back as the same
/// double.
pub(crate) fn write_numbers<W: Write>(
    writer: &mut csv::Writer<W>,
    numbers: impl IntoIterator<Item = f64>,
) -> csv::Result<()> {
    numbers
        .into_iter()
        .try_for_each(|number| writer.write_field(number.to_string()))
}

/// Writes a trace: the first row, every `every`-th after it, and always the hand-over and the last.
///
/// # Errors
/// Those of the writer.
pub fn write(trace: &Trace, every: usize, out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    let hand_over = trace.hand_over.map(|hand_over| hand_over.row);
    for tick in written(trace.rows.len(), every, hand_over) {
        let row = &trace.rows[tick];
        write_numbers(&mut writer, numbers(row))?;
        writer.write_field(phase(row))?;
        for flag in [
            Some(tick) == hand_over,
            row.has_transition_offset(),
            row.relaxing,
            row.report.saturated,
        ] {
            writer.write_field(if flag { "1" } else { "0" })?;
        }
        writer.write_field(tick.to_string())?;
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    Ok(())
}

fn phase(row: &TraceRow) -> &'static str {
    match row.report.phase {
        Phase::Tracking => "tracking",
        Phase::Parking => "parking",
    }
}

fn numbers(row: &TraceRow) -> [f64; 31] {
    let (pose, twist) = (row.truth.pose, row.truth.twist);
    let reference = row.reference;
    let report = &row.report;
    let neurons = report.neurons;
    [
        row.t,
        pose.x,
        pose.y,
        pose.theta,
        twist.linear,
        twist.angular,
        reference.pose().x,
        reference.pose().y,
        reference.pose().theta,
        reference.twist().linear,
        reference.twist().angular,
        reference.accel().linear,
        reference.accel().angular,
        report.error.x,
        report.error.y,
        report.error.theta,
        neurons.s1,
        neurons.s2,
        neurons.s3,
        neurons.accel.linear,
        neurons.accel.angular,
        report.command.linear,
        report.command.angular,
        report.command_rate.linear,
        report.command_rate.angular,
        report.transition_offset.linear,
        report.transition_offset.angular,
        report.wrench.force,
        report.wrench.moment,
        row.torques.right,
        row.torques.left,
    ]
}
