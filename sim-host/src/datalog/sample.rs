//! A tick in the terms that all robots have in common.

use crate::campaign::Tick;
use crate::csv_out::outcome_name;
use crate::monitor::LatestTelemetry;
use crate::run::{Seen, WheelStates};
use crate::trace::{cause, has_stopped, state_name};
use controller_core::motion::{Mode, Outcome};
use controller_core::safety::FaultKind;
use controller_core::safety::supervisor::{Cause, State};
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use protocol::BaseTick;

/// A tick.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Since the beginning \[s\].
    pub time_s: f64,
    /// What the base knows of itself; none before the first reading.
    pub measured: Option<Measured<f64>>,
    /// Where it truly is, if anybody knows.
    pub truth: Option<Pose<f64>>,
    /// Where it is to be.
    pub reference: Option<Pose<f64>>,
    /// What the wheels are to exert from now on.
    pub torques: WheelTorques<f64>,
    /// The wheels, where they have encoders that say something.
    pub wheels: Option<WheelStates>,
    /// How it fares.
    pub status: Status,
}

/// How a base fares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// For lamps.
    pub level: Level,
    /// One word.
    pub state: &'static str,
    /// Why it is that; empty if nobody says.
    pub cause: String,
    /// Found in this tick, by their names in configuration files.
    pub faults: Vec<&'static str>,
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Nothing to be said.
    Ok,
    /// A fault that does not keep it from driving, a stop by order, or a goal that is not reached.
    Warning,
    /// Stopped by a fault.
    Error,
}

impl Status {
    fn of(state: State, why: Option<&Cause>, faults: Vec<&'static str>) -> Self {
        let level = match why {
            Some(Cause::Fault(_)) if has_stopped(state) => Level::Error,
            _ if has_stopped(state) || !faults.is_empty() => Level::Warning,
            _ => Level::Ok,
        };
        Self {
            level,
            state: state_name(state),
            cause: why.map_or_else(String::new, cause),
            faults,
        }
    }
}

impl From<&Seen<'_>> for Sample {
    fn from(seen: &Seen<'_>) -> Self {
        let row = seen.line.row;
        let report = &row.report;
        let status = match &row.base {
            Some(base) => {
                let faults = base.active_faults.iter().map(|fault| fault.kind().name());
                Status::of(base.state, Some(&base.cause), faults.collect())
            }
            // Without a supervisor the law says how it fares.
            None => Status {
                level: match report.outcome {
                    Outcome::Driving | Outcome::Parked => Level::Ok,
                    _ => Level::Warning,
                },
                state: match (report.outcome, report.mode) {
                    (Outcome::Driving, Mode::Following) => "following",
                    (Outcome::Driving, Mode::Parking) => "parking",
                    (outcome, _) => outcome_name(outcome),
                },
                cause: String::new(),
                faults: Vec::new(),
            },
        };
        Self {
            time_s: row.t,
            measured: Some(seen.measured),
            truth: Some(row.truth.pose),
            reference: Some(*row.reference.pose()),
            torques: row.base.map_or(report.torques, |base| base.asked),
            wheels: seen.wheels,
            status,
        }
    }
}

impl From<&Tick<'_, '_>> for Sample {
    fn from(tick: &Tick<'_, '_>) -> Self {
        let report = tick.board.report();
        let faults = report.active_faults.iter().map(|fault| fault.kind().name());
        let torques = report.action.torques().unwrap_or_default();
        Self {
            time_s: tick.t,
            measured: report.measured.map(|measured| measured.cast()),
            truth: Some(tick.board.world().truth().pose),
            reference: None,
            torques: torques.cast(),
            wheels: WheelStates::of(tick.board.world()),
            status: Status::of(report.state, Some(&report.cause), faults.collect()),
        }
    }
}

impl Sample {
    /// Of a board's report that came at `time_s`.
    pub fn of_board(time_s: f64, tick: &BaseTick, latest: &LatestTelemetry) -> Self {
        let faults = tick.codes().filter_map(FaultKind::from_code);
        let why = latest.state.as_ref().map(|(_, cause)| cause);
        Self {
            time_s,
            measured: Some(Measured {
                pose: Pose::new(tick.x.into(), tick.y.into(), tick.theta.into()),
                twist: Twist::new(tick.v.into(), tick.w.into()),
            }),
            truth: None,
            reference: None,
            torques: WheelTorques {
                right: tick.tau_right.into(),
                left: tick.tau_left.into(),
            },
            wheels: None,
            status: Status::of(tick.state, why, faults.map(FaultKind::name).collect()),
        }
    }
}
