//! What stands of a run in a JSON file.

use crate::drive::DriveMetrics;
use crate::job::Trajectory;
use crate::metrics::Metrics;
use crate::mission::Mission;
use crate::pil::{BaseCost, Cost, Footprint, Parity};
use crate::precision::Precision;
use crate::scenario::{ControlLaw, Controller, Scenario};
use crate::trace::Trace;
use serde::Serialize;

/// The file of these records.
///
/// # Errors
/// Those of the serialiser, of which there are none for records.
pub fn text(records: &[impl Serialize]) -> serde_json::Result<String> {
    let mut text = serde_json::to_string_pretty(records)?;
    text.push('\n');
    Ok(text)
}

/// A scenario or a mission that has been run.
#[derive(Clone, Debug)]
pub struct Finished {
    /// Of the scenario.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Which controller drove.
    pub controller: ControllerRecord,
    /// \[s\].
    pub duration_s: f64,
    /// What happened.
    pub trace: Trace,
    /// Its figures.
    pub metrics: Metrics,
}

impl Finished {
    /// A run of a scenario, with its metrics; none of a trace without rows.
    pub fn scenario(scenario: &Scenario, trace: Trace) -> Option<Self> {
        Some(Self {
            name: scenario.name.clone(),
            description: scenario.description.clone(),
            controller: ControllerRecord::Paper(scenario.controller),
            duration_s: scenario.duration_s,
            metrics: Metrics::of(&trace)?,
            trace,
        })
    }

    /// A run of a mission, as far as all laws have it in common; none of a trace without rows.
    pub fn mission(mission: &Mission, trace: Trace) -> Option<Self> {
        Some(Self {
            name: mission.name.clone(),
            description: mission.description.clone(),
            controller: ControllerRecord::Motion {
                kind: "motion",
                precision: mission.precision,
            },
            duration_s: trace.rows.last().map_or(0.0, |row| row.t),
            metrics: Metrics::of(&trace)?,
            trace,
        })
    }
}

/// Metrics of one run, as they stand in a JSON file.
#[derive(Debug, Serialize)]
pub struct Record<'a> {
    /// Its name.
    pub scenario: &'a str,
    /// One line for people.
    pub description: &'a str,
    /// Which controller drove.
    pub controller: ControllerRecord,
    /// Control period \[s\].
    pub period_s: f64,
    /// \[s\].
    pub duration_s: f64,
    /// Figures.
    pub metrics: &'a Metrics,
    /// Only of a run with the controller on a chip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chip: Option<ChipRecord>,
}

impl<'a> From<&'a Finished> for Record<'a> {
    fn from(run: &'a Finished) -> Self {
        Self {
            scenario: &run.name,
            description: &run.description,
            controller: run.controller,
            period_s: run.trace.period_s,
            duration_s: run.duration_s,
            metrics: &run.metrics,
            chip: None,
        }
    }
}

/// Which controller drove.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ControllerRecord {
    /// One of the paper's.
    Paper(Controller),
    /// The default law.
    Motion {
        /// Always "motion".
        kind: &'static str,
        /// Its number type.
        precision: Precision,
    },
}

impl ControllerRecord {
    /// The law's name in tables and legends.
    pub fn law(&self) -> &'static str {
        match self {
            Self::Paper(controller) => match controller.kind {
                ControlLaw::Neural => "neural",
                ControlLaw::Plain => "plain",
            },
            Self::Motion { kind, .. } => kind,
        }
    }
}

/// What the JSON file says of the chip.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ChipRecord<C = Cost> {
    /// The emulated chip.
    pub machine: &'static str,
    /// The way to it.
    pub link: &'static str,
    /// Chip against host.
    pub parity: Parity,
    /// Executed instructions of the controller's step, or of the control task's tick.
    pub instructions: C,
    /// High-water mark since the firmware was started.
    pub stack_bytes: u32,
    /// Sizes.
    pub image: Footprint,
    /// Of real time.
    pub ticks_per_second: f64,
}

/// A mission, as it stands in a JSON file.
#[derive(Debug, Serialize)]
pub struct DriveRecord<'a> {
    scenario: &'a str,
    description: &'a str,
    base: &'a str,
    controller: &'static str,
    precision: Precision,
    period_s: f64,
    duration_s: f64,
    /// Of a trajectory file.
    #[serde(skip_serializing_if = "Option::is_none")]
    stretched_by: Option<f64>,
    /// Of a trajectory file whose path was smoothed: its largest departure.
    #[serde(skip_serializing_if = "Option::is_none")]
    departure_m: Option<f64>,
    /// Of a trajectory file, one line each.
    repairs: Vec<String>,
    metrics: &'a DriveMetrics,
    #[serde(skip_serializing_if = "Option::is_none")]
    chip: Option<&'a ChipRecord<BaseCost>>,
}

impl<'a> DriveRecord<'a> {
    /// Of a mission that was run, after a trajectory `file` if it was one.
    pub fn of(
        mission: &'a Mission,
        file: Option<&Trajectory>,
        trace: &Trace,
        metrics: &'a DriveMetrics,
        chip: Option<&'a ChipRecord<BaseCost>>,
    ) -> Self {
        let repairs = file.map_or(&[][..], |file| file.read.repairs());
        Self {
            scenario: &mission.name,
            description: &mission.description,
            base: &mission.base.name,
            controller: "motion",
            precision: mission.precision,
            period_s: mission.period_s,
            duration_s: trace.rows.last().map_or(0.0, |row| row.t),
            stretched_by: file.map(|file| file.scaling.factor),
            departure_m: file.and_then(|file| Some(file.scaling.departure?.position_m)),
            repairs: repairs.iter().map(ToString::to_string).collect(),
            metrics,
            chip,
        }
    }
}
