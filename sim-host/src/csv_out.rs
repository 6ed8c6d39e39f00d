//! Traces as CSV: full precision, one row per control tick.

use crate::trace::{PaperTerms, Trace, TraceRow, cause, fix_name, state_name};
use controller_core::motion::{Mode, Outcome};
use std::borrow::Cow;
use std::io::Write;

/// Whose columns are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Columns {
    /// The paper's laws', and those that all laws have.
    Paper,
    /// The default law's, and those that all laws have.
    Motion,
}

impl Columns {
    /// The names, in order.
    pub fn names(self) -> Vec<&'static str> {
        self.all().map(|column| column.name).collect()
    }

    fn all(self) -> impl Iterator<Item = &'static Column> {
        COLUMNS
            .iter()
            .filter(move |column| column.only.is_none_or(|only| only == self))
    }
}

/// A row and its place in the trace.
struct Line<'a> {
    tick: usize,
    row: &'a TraceRow,
    handed_over: bool,
}

impl Line<'_> {
    fn paper(&self) -> PaperTerms {
        self.row.paper.unwrap_or_default()
    }
}

enum Field {
    /// `Display` of a double is the shortest text that reads back as the same double.
    Number(fn(&Line<'_>) -> f64),
    Count(fn(&Line<'_>) -> usize),
    /// 0 or 1.
    Flag(fn(&Line<'_>) -> bool),
    Word(fn(&Line<'_>) -> Cow<'static, str>),
}

struct Column {
    name: &'static str,
    /// None of all laws.
    only: Option<Columns>,
    field: Field,
}

const fn all(name: &'static str, field: Field) -> Column {
    Column {
        name,
        only: None,
        field,
    }
}

const fn paper(name: &'static str, field: Field) -> Column {
    Column {
        only: Some(Columns::Paper),
        ..all(name, field)
    }
}

const fn motion(name: &'static str, field: Field) -> Column {
    Column {
        only: Some(Columns::Motion),
        ..all(name, field)
    }
}

use Field::{Count, Flag, Number, Word};

/// All columns, in order. SI units, radians.
///
/// * x … w: the robot as it truly is; x_m … theta_m: the pose that the controller got.
/// * x_r … wdot_r: the reference (for the default law with the acceleration half a tick ahead); while parking the goal.
/// * e_x … e_theta: the error that the controller computed; s1 … wdot_s: the neurons, 0 without a part in the phase;
///   v_d … wdot_d: what the pose law wants.
/// * b_v, b_w: transition offsets within the command, which is v_c … wdot_c; d_v, d_w: measured minus commanded twist.
/// * dist1, dist2: estimated force \[N\] and moment \[N m\] beside the wheels.
/// * tau1, tau2: force \[N\] and moment \[N m\] that the law demands; tau_right, tau_left: what acts on the wheels until
///   the next row.
/// * phase: `tracking` or `parking`; mode: `following` or `parking`; outcome: `driving`, `parked`, `stalled` or
///   `out-of-tolerance`; flags are 0 or 1; retries: how often the robot tried the goal again.
/// * state, cause: of the whole base; fix: what became of an external pose in this tick, `fused`, `rejected`,
///   `relocalised`, `refused`. Empty on the ideal plant.
static COLUMNS: [Column; 63] = [
    all("t", Number(|l| l.row.t)),
    all("x", Number(|l| l.row.truth.pose.x)),
    all("y", Number(|l| l.row.truth.pose.y)),
    all("theta", Number(|l| l.row.truth.pose.theta)),
    all("v", Number(|l| l.row.truth.twist.linear)),
    all("w", Number(|l| l.row.truth.twist.angular)),
    motion("x_m", Number(|l| l.row.measured.x)),
    motion("y_m", Number(|l| l.row.measured.y)),
    motion("theta_m", Number(|l| l.row.measured.theta)),
    all("x_r", Number(|l| l.row.reference.pose().x)),
    all("y_r", Number(|l| l.row.reference.pose().y)),
    all("theta_r", Number(|l| l.row.reference.pose().theta)),
    all("v_r", Number(|l| l.row.reference.twist().linear)),
    all("w_r", Number(|l| l.row.reference.twist().angular)),
    all("vdot_r", Number(|l| l.row.reference.accel().linear)),
    all("wdot_r", Number(|l| l.row.reference.accel().angular)),
    all("e_x", Number(|l| l.row.report.error.x)),
    all("e_y", Number(|l| l.row.report.error.y)),
    all("e_theta", Number(|l| l.row.report.error.theta)),
    paper("s1", Number(|l| l.paper().neurons.s1)),
    paper("s2", Number(|l| l.paper().neurons.s2)),
    paper("s3", Number(|l| l.paper().neurons.s3)),
    paper("vdot_s", Number(|l| l.paper().neurons.accel.linear)),
    paper("wdot_s", Number(|l| l.paper().neurons.accel.angular)),
    motion("v_d", Number(|l| l.row.report.desired.linear)),
    motion("w_d", Number(|l| l.row.report.desired.angular)),
    motion("vdot_d", Number(|l| l.row.report.desired_rate.linear)),
    motion("wdot_d", Number(|l| l.row.report.desired_rate.angular)),
    motion("b_v", Number(|l| l.row.report.transition_offset.linear)),
    motion("b_w", Number(|l| l.row.report.transition_offset.angular)),
    all("v_c", Number(|l| l.row.report.command.linear)),
    all("w_c", Number(|l| l.row.report.command.angular)),
    all("vdot_c", Number(|l| l.row.report.command_rate.linear)),
    all("wdot_c", Number(|l| l.row.report.command_rate.angular)),
    // The same as above: files of the paper's laws have them here.
    paper("b_v", Number(|l| l.row.report.transition_offset.linear)),
    paper("b_w", Number(|l| l.row.report.transition_offset.angular)),
    motion("d_v", Number(|l| l.row.report.velocity_error.linear)),
    motion("d_w", Number(|l| l.row.report.velocity_error.angular)),
    motion("dist1", Number(|l| l.row.report.disturbance.force)),
    motion("dist2", Number(|l| l.row.report.disturbance.moment)),
    all("tau1", Number(|l| l.row.report.wrench.force)),
    all("tau2", Number(|l| l.row.report.wrench.moment)),
    all("tau_right", Number(|l| l.row.report.torques.right)),
    all("tau_left", Number(|l| l.row.report.torques.left)),
    paper("phase", Word(|l| mode(l, "tracking"))),
    paper("handed_over", Flag(|l| l.handed_over)),
    paper("bridging", Flag(|l| l.row.has_transition_offset())),
    paper("relaxing", Flag(|l| l.paper().relaxing)),
    paper("saturated", Flag(|l| l.row.report.limited.torque)),
    motion("mode", Word(|l| mode(l, "following"))),
    motion(
        "outcome",
        Word(|l| outcome_name(l.row.report.outcome).into()),
    ),
    motion("speed_limited", Flag(|l| l.row.report.limited.speed)),
    motion("accel_limited", Flag(|l| l.row.report.limited.accel)),
    motion("jerk_limited", Flag(|l| l.row.report.limited.jerk)),
    motion("torque_limited", Flag(|l| l.row.report.limited.torque)),
    motion(
        "disturbance_limited",
        Flag(|l| l.row.report.limited.disturbance),
    ),
    motion("jumped", Flag(|l| l.row.report.jumped)),
    motion("backing", Flag(|l| l.row.report.backing)),
    motion("retries", Count(|l| l.row.report.retries.into())),
    all("tick", Count(|l| l.tick)),
    motion(
        "state",
        Word(|l| l.row.base.map_or("", |base| state_name(base.state)).into()),
    ),
    motion(
        "cause",
        Word(|l| {
            l.row
                .base
                .map_or_else(String::new, |base| cause(&base.cause))
                .into()
        }),
    ),
    motion(
        "fix",
        Word(|l| l.row.base.map_or("", |base| fix_name(&base.fix)).into()),
    ),
];

fn mode(line: &Line<'_>, moving: &'static str) -> Cow<'static, str> {
    Cow::Borrowed(match line.row.report.mode {
        Mode::Following => moving,
        Mode::Parking => "parking",
    })
}

/// One word for an outcome.
pub fn outcome_name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Parked => "parked",
        Outcome::Stalled => "stalled",
        Outcome::OutOfTolerance => "out-of-tolerance",
        _ => "driving",
    }
}

/// Writes numbers as fields.
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
pub fn write(trace: &Trace, columns: Columns, every: usize, out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(columns.names())?;
    let hand_over = match columns {
        // As the paper has it: the one that the run ends with.
        Columns::Paper => trace.parking(),
        Columns::Motion => trace.hand_over,
    };
    let hand_over = hand_over.map(|hand_over| hand_over.row);
    let last = trace.rows.len().saturating_sub(1);
    for (tick, row) in trace.rows.iter().enumerate() {
        let line = Line {
            tick,
            row,
            handed_over: Some(tick) == hand_over,
        };
        if !(tick % every.max(1) == 0 || tick == last || line.handed_over) {
            continue;
        }
        for column in columns.all() {
            match column.field {
                Number(of) => writer.write_field(of(&line).to_string()),
                Count(of) => writer.write_field(of(&line).to_string()),
                Flag(of) => writer.write_field(if of(&line) { "1" } else { "0" }),
                Word(of) => writer.write_field(of(&line).as_bytes()),
            }?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    Ok(())
}
