//! Files.

use super::error::CommandError;
use crate::cli::Output;
use serde::Serialize;
use sim_host::csv_out::{self, Columns};
use sim_host::figure::{Labelled, five_panels, png};
use sim_host::metrics::Metrics;
use sim_host::pil::{Cost, Footprint, Parity};
use sim_host::precision::Precision;
use sim_host::scenario::{ControlLaw, Controller};
use sim_host::trace::Trace;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Metrics of one run, as they stand in a JSON file.
#[derive(Serialize)]
pub struct Record<'a> {
    pub scenario: &'a str,
    pub description: &'a str,
    pub controller: ControllerRecord,
    pub period_s: f64,
    pub duration_s: f64,
    pub metrics: &'a Metrics,
    /// Only of a run with the controller on a chip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chip: Option<ChipRecord>,
}

impl<'a> From<&'a super::Finished> for Record<'a> {
    fn from(run: &'a super::Finished) -> Self {
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
#[derive(Clone, Copy, Serialize)]
pub struct ChipRecord<C = Cost> {
    pub machine: &'static str,
    pub link: &'static str,
    pub parity: Parity,
    /// Executed instructions of the controller's step, or of the control task's tick.
    pub instructions: C,
    /// High-water mark since the firmware was started.
    pub stack_bytes: u32,
    pub image: Footprint,
    pub ticks_per_second: f64,
}

/// Writes results and remembers what it wrote.
pub struct Writer<'a> {
    output: &'a Output,
}

impl<'a> Writer<'a> {
    pub fn new(output: &'a Output) -> Result<Self, CommandError> {
        fs::create_dir_all(&output.out).map_err(|error| failed(&output.out, &error))?;
        Ok(Self { output })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.output.out.join(name)
    }

    pub fn figure(
        &self,
        name: &str,
        title: &str,
        main: Labelled<'_>,
        other: Option<Labelled<'_>>,
    ) -> Result<(), CommandError> {
        let svg = five_panels(title, main, other)?;
        let raster = png(&svg)?;
        for (extension, bytes) in [("svg", svg.as_bytes()), ("png", &raster)] {
            let path = self.path(&format!("{name}.{extension}"));
            fs::write(&path, bytes).map_err(|error| failed(&path, &error))?;
        }
        Ok(())
    }

    pub fn csv(&self, name: &str, trace: &Trace, columns: Columns) -> Result<(), CommandError> {
        let every = self.output.every.get();
        self.rows(name, |out| csv_out::write(trace, columns, every, out))
    }

    /// A CSV file, by what writes it.
    pub fn rows(
        &self,
        name: &str,
        write: impl FnOnce(BufWriter<File>) -> csv::Result<()>,
    ) -> Result<(), CommandError> {
        let path = self.path(&format!("{name}.csv"));
        let file = File::create(&path).map_err(|error| failed(&path, &error))?;
        write(BufWriter::new(file)).map_err(|error| failed(&path, &error))
    }

    /// A file of that very name.
    pub fn bytes(&self, name: &str, bytes: &[u8]) -> Result<(), CommandError> {
        let path = self.path(name);
        fs::write(&path, bytes).map_err(|error| failed(&path, &error))
    }

    pub fn json(&self, name: &str, records: &[impl Serialize]) -> Result<(), CommandError> {
        let path = self.path(&format!("{name}.json"));
        let mut text =
            serde_json::to_string_pretty(records).map_err(|error| failed(&path, &error))?;
        text.push('\n');
        fs::write(&path, text).map_err(|error| failed(&path, &error))
    }
}

fn failed(path: &Path, cause: &dyn std::error::Error) -> CommandError {
    CommandError::Write {
        path: path.to_owned(),
        cause: cause.to_string(),
    }
}
