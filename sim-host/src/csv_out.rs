//! CSV: files are lists of columns, traces among them. Full precision, one row per control tick.

use crate::trace::{PaperTerms, Trace, TraceRow, cause, fix_name, state_name};
use controller_core::motion::{Mode, Outcome};
use std::io::Write;

/// A column: its name, and what stands in it.
pub(crate) type Column<R> = (&'static str, fn(&R) -> Cell);

/// A list of columns, which says the name of each beside its value in a row. A word before the name goes with it.
macro_rules! columns {
    ($row:ident; $($name:literal => $value:expr,)+) => {
        [$(($name, |$row| $crate::csv_out::Field::cell(&$value))),+]
    };
    ($row:ident; $($word:ident $name:literal => $value:expr,)+) => {
        [$(($word, ($name, |$row| $crate::csv_out::Field::cell(&$value)))),+]
    };
}
pub(crate) use columns;

/// What stands in a field. Its `Display` is what stands in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing, where there could be this: an empty field.
    Nothing(Kind),
    /// The shortest text of a float that reads back as the same float.
    Number(f64),
    /// The same of a single.
    Single(f32),
    /// A float with an exponent.
    Scientific(f64),
    /// A float with six decimals.
    Fixed(f64),
    /// A count or a number of something.
    Whole(u64),
    /// 0 or 1.
    Flag(bool),
    /// A word or more.
    Text(String),
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Nothing(_) => Ok(()),
            Self::Number(number) => number.fmt(f),
            Self::Single(number) => number.fmt(f),
            Self::Scientific(number) => write!(f, "{number:e}"),
            Self::Fixed(number) => write!(f, "{number:.6}"),
            Self::Whole(number) => number.fmt(f),
            Self::Flag(flag) => u8::from(*flag).fmt(f),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// What the fields of a column have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Floats.
    Number,
    /// Counts, numbers of something.
    Whole,
    /// 0 or 1.
    Flag,
    /// Words.
    Text,
}

impl Cell {
    /// What its column is of.
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Nothing(kind) => *kind,
            Self::Number(_) | Self::Single(_) | Self::Scientific(_) | Self::Fixed(_) => {
                Kind::Number
            }
            Self::Whole(_) => Kind::Whole,
            Self::Flag(_) => Kind::Flag,
            Self::Text(_) => Kind::Text,
        }
    }
}

/// What can stand in a field.
pub(crate) trait Field {
    const KIND: Kind;
    fn cell(&self) -> Cell;
}

macro_rules! as_cells {
    ($($field:ty, $kind:ident, $value:ident => $cell:expr;)+) => { $(impl Field for $field {
        const KIND: Kind = Kind::$kind;
        fn cell(&self) -> Cell {
            let $value = self;
            $cell
        }
    })+ };
}
as_cells! {
    f64, Number, number => Cell::Number(*number);
    f32, Number, number => Cell::Single(*number);
    u8, Whole, number => Cell::Whole(u64::from(*number));
    u32, Whole, number => Cell::Whole(u64::from(*number));
    u64, Whole, number => Cell::Whole(*number);
    usize, Whole, number => Cell::Whole(*number as u64);
    bool, Flag, flag => Cell::Flag(*flag);
    str, Text, text => Cell::Text(text.to_owned());
    String, Text, text => Cell::Text(text.clone());
    Scientific, Number, number => Cell::Scientific(number.0);
    Fixed, Number, number => Cell::Fixed(number.0);
}

/// A number that is written with an exponent.
pub(crate) struct Scientific(pub(crate) f64);

/// A number that is written with six decimals.
pub(crate) struct Fixed(pub(crate) f64);

impl<T: Field + ?Sized> Field for &T {
    const KIND: Kind = T::KIND;
    fn cell(&self) -> Cell {
        (**self).cell()
    }
}

/// Empty where there is nothing.
impl<T: Field> Field for Option<T> {
    const KIND: Kind = T::KIND;
    fn cell(&self) -> Cell {
        self.as_ref().map_or(Cell::Nothing(T::KIND), Field::cell)
    }
}

/// The fields of a row, with the names of their columns.
pub(crate) fn fields<R>(columns: &[Column<R>], row: &R) -> Vec<(&'static str, Cell)> {
    let fields = columns.iter().map(|(name, cell)| (*name, cell(row)));
    fields.collect()
}

/// The names, in order.
pub(crate) fn names<R>(columns: &[Column<R>]) -> Vec<&'static str> {
    columns.iter().map(|(name, _)| *name).collect()
}

/// Writes a row.
pub(crate) fn write_row<R>(
    writer: &mut csv::Writer<impl Write>,
    columns: &[Column<R>],
    row: &R,
) -> csv::Result<()> {
    writer.write_record(columns.iter().map(|(_, cell)| cell(row).to_string()))
}

/// Writes a file: its header, and all rows.
pub(crate) fn write_file<R>(
    columns: &[Column<R>],
    rows: impl IntoIterator<Item = R>,
    out: impl Write,
) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(names(columns))?;
    for row in rows {
        write_row(&mut writer, columns, &row)?;
    }
    Ok(writer.flush()?)
}

/// A table by its columns: what the file of the same table has in its fields, for programs.
pub type Sheet = Vec<(&'static str, Vec<Cell>)>;

/// All fields of a table, column by column.
pub(crate) fn sheet<R>(columns: &[Column<R>], rows: impl IntoIterator<Item = R>) -> Sheet {
    let mut sheet: Sheet = names(columns)
        .into_iter()
        .map(|name| (name, vec![]))
        .collect();
    for row in rows {
        for ((_, cells), (_, cell)) in sheet.iter_mut().zip(columns) {
            cells.push(cell(&row));
        }
    }
    sheet
}

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
        names(&self.all())
    }

    /// Rows with their fields, in the order of their names. What a whole base computed are singles here, as on its chip.
    pub fn fields<'a>(
        self,
        lines: impl Iterator<Item = Line<'a>>,
    ) -> impl Iterator<Item = (Line<'a>, Vec<(&'static str, Cell)>)> {
        let columns = self.all();
        lines.map(move |line| {
            let mut fields = fields(&columns, &line);
            if line.row.base.is_some() {
                for (name, cell) in &mut fields {
                    if let Cell::Number(number) = cell
                        && is_computed(name)
                    {
                        *cell = Cell::Single(*number as f32);
                    }
                }
            }
            (line, fields)
        })
    }

    fn all<'a>(self) -> Vec<Column<Line<'a>>> {
        let columns = all_columns().into_iter();
        let kept = columns.filter(|(only, _)| only.is_none_or(|only| only == self));
        kept.map(|(_, column)| column).collect()
    }
}

/// A row and its place in the trace.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Index in the trace.
    pub tick: usize,
    /// The row.
    pub row: &'a TraceRow,
    /// Parking took over in it.
    pub handed_over: bool,
}

impl Line<'_> {
    fn paper(&self) -> PaperTerms {
        self.row.paper.unwrap_or_default()
    }
}

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
/// * phase: `tracking` or `parking`; mode: `following`, `parking` or `driving` by velocity; outcome: `driving`, `parked`, `stalled` or
///   `out-of-tolerance`; flags are 0 or 1; retries: how often the robot tried the goal again.
/// * state, cause: of the whole base; fix: what became of an external pose in this tick, `fused`, `rejected`,
///   `relocalised`, `refused`. Empty on the ideal plant.
fn all_columns<'a>() -> [(Option<Columns>, Column<Line<'a>>); 64] {
    let (all, paper, motion) = (None, Some(Columns::Paper), Some(Columns::Motion));
    columns![l;
        all "t" => l.row.t,
        all "x" => l.row.truth.pose.x,
        all "y" => l.row.truth.pose.y,
        all "theta" => l.row.truth.pose.theta,
        all "v" => l.row.truth.twist.linear,
        all "w" => l.row.truth.twist.angular,
        motion "x_m" => l.row.measured.x,
        motion "y_m" => l.row.measured.y,
        motion "theta_m" => l.row.measured.theta,
        all "x_r" => l.row.reference.pose().x,
        all "y_r" => l.row.reference.pose().y,
        all "theta_r" => l.row.reference.pose().theta,
        all "v_r" => l.row.reference.twist().linear,
        all "w_r" => l.row.reference.twist().angular,
        all "vdot_r" => l.row.reference.accel().linear,
        all "wdot_r" => l.row.reference.accel().angular,
        all "e_x" => l.row.report.error.x,
        all "e_y" => l.row.report.error.y,
        all "e_theta" => l.row.report.error.theta,
        paper "s1" => l.paper().neurons.s1,
        paper "s2" => l.paper().neurons.s2,
        paper "s3" => l.paper().neurons.s3,
        paper "vdot_s" => l.paper().neurons.accel.linear,
        paper "wdot_s" => l.paper().neurons.accel.angular,
        motion "v_d" => l.row.report.desired.linear,
        motion "w_d" => l.row.report.desired.angular,
        motion "vdot_d" => l.row.report.desired_rate.linear,
        motion "wdot_d" => l.row.report.desired_rate.angular,
        motion "b_v" => l.row.report.transition_offset.linear,
        motion "b_w" => l.row.report.transition_offset.angular,
        all "v_c" => l.row.report.command.linear,
        all "w_c" => l.row.report.command.angular,
        all "vdot_c" => l.row.report.command_rate.linear,
        all "wdot_c" => l.row.report.command_rate.angular,
        // The same as above: files of the paper's laws have them here.
        paper "b_v" => l.row.report.transition_offset.linear,
        paper "b_w" => l.row.report.transition_offset.angular,
        motion "d_v" => l.row.report.velocity_error.linear,
        motion "d_w" => l.row.report.velocity_error.angular,
        motion "dist1" => l.row.report.disturbance.force,
        motion "dist2" => l.row.report.disturbance.moment,
        all "tau1" => l.row.report.wrench.force,
        all "tau2" => l.row.report.wrench.moment,
        all "tau_right" => l.row.report.torques.right,
        all "tau_left" => l.row.report.torques.left,
        paper "phase" => mode(l, "tracking"),
        paper "handed_over" => l.handed_over,
        paper "bridging" => l.row.has_transition_offset(),
        paper "relaxing" => l.paper().relaxing,
        paper "saturated" => l.row.report.limited.torque,
        motion "mode" => mode(l, "following"),
        motion "outcome" => outcome_name(l.row.report.outcome),
        motion "speed_limited" => l.row.report.limited.speed,
        motion "accel_limited" => l.row.report.limited.accel,
        motion "jerk_limited" => l.row.report.limited.jerk,
        motion "torque_limited" => l.row.report.limited.torque,
        motion "disturbance_limited" => l.row.report.limited.disturbance,
        motion "grip_limited" => l.row.report.limited.grip,
        motion "jumped" => l.row.report.jumped,
        motion "backing" => l.row.report.backing,
        motion "retries" => l.row.report.retries,
        all "tick" => l.tick,
        motion "state" => l.row.base.map(|base| state_name(base.state)),
        motion "cause" => l.row.base.map(|base| cause(&base.cause)),
        motion "fix" => l.row.base.map(|base| fix_name(&base.fix)),
    ]
}

/// A number that the controller computed in its own precision: not of the plant, nor of the reference, nor a pose, which
/// before the first reading is that of the mission.
fn is_computed(column: &str) -> bool {
    let known = ["t", "x", "y", "theta", "v", "w"];
    !known.contains(&column) && !column.ends_with("_r") && !column.ends_with("_m")
}

/// The unit of a column of a trace; empty for words, flags and numbers of something.
pub fn unit(column: &str) -> &'static str {
    match column {
        "t" => "s",
        "x" | "y" | "x_m" | "y_m" | "x_r" | "y_r" | "e_x" | "e_y" | "s1" | "s2" => "m",
        "theta" | "theta_m" | "theta_r" | "e_theta" | "s3" => "rad",
        "v" | "v_r" | "v_d" | "v_c" | "b_v" | "d_v" => "m/s",
        "w" | "w_r" | "w_d" | "w_c" | "b_w" | "d_w" => "rad/s",
        "vdot_r" | "vdot_s" | "vdot_d" | "vdot_c" => "m/s^2",
        "wdot_r" | "wdot_s" | "wdot_d" | "wdot_c" => "rad/s^2",
        "dist1" | "tau1" => "N",
        "dist2" | "tau2" | "tau_right" | "tau_left" => "N m",
        _ => "",
    }
}

fn mode(line: &Line<'_>, moving: &'static str) -> &'static str {
    match line.row.report.mode {
        Mode::Following => moving,
        Mode::Parking => "parking",
        Mode::Driving => "driving",
    }
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

/// Writes a trace: the first row, every `every`-th after it, and always the hand-over and the last.
///
/// # Errors
/// Those of the writer.
pub fn write(trace: &Trace, columns: Columns, every: usize, out: impl Write) -> csv::Result<()> {
    let last = trace.rows.len().saturating_sub(1);
    let kept = lines(trace, columns)
        .filter(|l| l.tick % every.max(1) == 0 || l.tick == last || l.handed_over);
    write_file(&columns.all(), kept, out)
}

/// Columns of a trace by their names, in the order of these; a name that there is not has none. All rows.
pub fn trace_sheet(trace: &Trace, columns: Columns, wanted: &[&str]) -> Sheet {
    let all = columns.all().into_iter();
    let chosen: Vec<_> = all.filter(|(name, _)| wanted.contains(name)).collect();
    sheet(&chosen, lines(trace, columns))
}

fn lines(trace: &Trace, columns: Columns) -> impl Iterator<Item = Line<'_>> {
    let hand_over = match columns {
        // As the paper has it: the one that the run ends with.
        Columns::Paper => trace.parking(),
        Columns::Motion => trace.hand_over,
    };
    let hand_over = hand_over.map(|hand_over| hand_over.row);
    let rows = trace.rows.iter().enumerate();
    rows.map(move |(tick, row)| Line {
        tick,
        row,
        handed_over: Some(tick) == hand_over,
    })
}
