//! A robot from the log of a drive.

use crate::arguments::positive;
use crate::{error, sheet};
use pyo3::prelude::*;
use sim_host::identify::{Identified, Known, Log, Options, identify as fit, profile, report};
use sim_host::record;
use std::path::{Path, PathBuf};

/// What a log determines.
#[pyclass(module = "twb", frozen)]
pub struct Identification {
    found: Identified,
    gear: Option<f64>,
}

impl Identification {
    fn entry<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let records = sheet::json(py, &self.json()?)?;
        records.get_item(0)?.get_item(key)
    }
}

#[pymethods]
impl Identification {
    /// A dictionary for each quantity: name, unit, meaning, verdict, and value with `half_width` of the 95 % interval,
    /// or why not and what would help.
    #[getter]
    fn quantities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.entry(py, "quantities")
    }

    /// The same for ratios and products whose parts are not known.
    #[getter]
    fn combinations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.entry(py, "combinations")
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.found.warnings.clone()
    }

    /// The table of the command line.
    #[getter]
    fn report(&self) -> String {
        report::text(&self.found)
    }

    /// The JSON file of the command line.
    fn json(&self) -> PyResult<String> {
        record::text(&[&self.found]).map_err(|e| error::run(&e.to_string()))
    }

    /// A robot's text with what was found, begun if it is empty; and notes for its owner.
    #[pyo3(signature = (text = ""))]
    fn update(&self, text: &str) -> PyResult<(String, Vec<String>)> {
        let updated = profile::update(text, &self.found, self.gear);
        let updated = updated.map_err(|e| error::argument("text", &e.to_string()))?;
        let notes = updated.notes.iter().map(ToString::to_string).collect();
        Ok((updated.text, notes))
    }

    fn __repr__(&self) -> String {
        let count = self.found.quantities.len();
        format!("<twb.Identification of {count} quantities>")
    }
}

/// Identifies a robot from the text of a log; `statements` are as on the command line, `mass=9.8`.
#[pyfunction]
#[pyo3(signature = (text, file, statements, counts_per_turn = None, latency_s = 0.0, slow_rad_s = None))]
pub fn identify(
    py: Python<'_>,
    text: Vec<u8>,
    file: PathBuf,
    statements: Vec<String>,
    counts_per_turn: Option<f64>,
    latency_s: f64,
    slow_rad_s: Option<f64>,
) -> PyResult<Identification> {
    if let Some(counts) = counts_per_turn {
        positive("counts_per_turn", counts, false)?;
    }
    positive("latency_s", latency_s, true)?;
    if let Some(slow) = slow_rad_s {
        positive("slow_rad_s", slow, false)?;
    }
    let mut known = Known::default();
    for statement in &statements {
        let stated = known.state(statement);
        stated.map_err(|e| error::argument("known", &e.to_string()))?;
    }
    let (gear, usual) = (known.gear, Options::default());
    let options = Options {
        known,
        latency_s,
        slow_rad_s: slow_rad_s.unwrap_or(usual.slow_rad_s),
    };
    let path: &Path = &file;
    let found = py.detach(|| {
        let log = Log::read(&text, counts_per_turn).map_err(|e| error::log(path, &e))?;
        fit(&log, &options).map_err(|e| error::content(path, &e.to_string()))
    })?;
    Ok(Identification { found, gear })
}
