//! The fault campaign, whole or in parts.

use crate::robot::{Robot, figures};
use crate::work::work;
use crate::{arguments, error, sheet};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use serde::{Deserialize, Serialize};
use sim_host::campaign::{
    Bases, Campaign as Settings, CampaignError, Mutation, Record, Robots, RunOutcome, cells,
    run_sheet, study, table, violation, write_runs,
};
use sim_host::job::RobotFile;
use sim_host::part;
use sim_host::record;
use std::path::PathBuf;

/// Its bases, and the numbers of its runs.
fn numbers(settings: &Settings) -> PyResult<(Bases, Vec<u64>)> {
    settings.numbers().map_err(|e| match e {
        CampaignError::Base(e) => error::scenario(&e),
        CampaignError::Limit { key, .. } => error::argument(key, &e.to_string()),
        e => error::argument("only", &e.to_string()),
    })
}

/// Runs of a campaign, in order.
#[pyclass(module = "twb", frozen)]
#[derive(Serialize, Deserialize)]
pub struct Campaign {
    parameters: Settings,
    outcomes: Vec<RunOutcome>,
}

#[pymethods]
impl Campaign {
    #[getter]
    fn seed(&self) -> u64 {
        self.parameters.seed
    }

    fn __len__(&self) -> usize {
        self.outcomes.len()
    }

    /// An array for each column of the CSV file.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        sheet::arrays(py, &run_sheet(&self.outcomes))
    }

    /// What is against the rules, one line each.
    #[getter]
    fn violations(&self) -> Vec<String> {
        self.outcomes.iter().filter_map(violation).collect()
    }

    /// A dictionary for each trouble and state.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let cells = cells(&self.outcomes, None);
        let record = Record::of(self.parameters.seed, &self.outcomes, &cells);
        figures(py, &record)?.get_item("cells")
    }

    /// The table of the command line.
    #[getter]
    fn report(&self) -> String {
        table(&cells(&self.outcomes, None)).to_string()
    }

    /// The CSV file of the command line.
    fn csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        write_runs(&self.outcomes, &mut bytes).map_err(|e| error::run(&e.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The JSON file of the command line.
    fn json(&self) -> PyResult<String> {
        let cells = cells(&self.outcomes, None);
        let record = Record::of(self.parameters.seed, &self.outcomes, &cells);
        record::text(&[record]).map_err(|e| error::run(&e.to_string()))
    }

    /// The campaign of its parts, in any order.
    #[staticmethod]
    fn merge(parts: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let Some(first) = parts.first() else {
            return Err(error::argument("parts", "there are no parts"));
        };
        let parameters = first.parameters.clone();
        if parts.iter().any(|part| part.parameters != parameters) {
            let message = "the parts are of several campaigns";
            return Err(error::argument("parts", message));
        }
        let all = parts.iter().flat_map(|part| part.outcomes.iter().cloned());
        let mut outcomes: Vec<RunOutcome> = all.collect();
        outcomes.sort_by_key(|outcome| outcome.run);
        let (_, numbers) = numbers(&parameters)?;
        if !outcomes.iter().map(|o| o.run).eq(numbers.iter().copied()) {
            let message = format!(
                "{} runs are here, of a campaign of {}: a part is missing or there twice",
                outcomes.len(),
                numbers.len()
            );
            return Err(error::argument("parts", &message));
        }
        Ok(Self {
            parameters,
            outcomes,
        })
    }

    /// The bits of all runs, to send elsewhere.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = postcard::to_allocvec(self).map_err(|e| error::run(&e.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Back from `to_bytes` of the same version.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let message = "no campaign of this version";
        postcard::from_bytes(bytes).map_err(|_| error::argument("bytes", message))
    }

    /// For pickle.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let from_bytes = py.get_type::<Self>().getattr("from_bytes")?;
        Ok((from_bytes, PyTuple::new(py, [self.to_bytes(py)?])?))
    }

    fn __repr__(&self) -> String {
        let (runs, seed) = (self.outcomes.len(), self.parameters.seed);
        let violations = self.violations().len();
        format!("<twb.Campaign of seed {seed}: {runs} runs, {violations} against the rules>")
    }
}

/// The fault campaign of a seed, or part `shard` of it: (index, count), counted from 0.
#[pyfunction]
#[pyo3(signature = (robot = None, runs = 1000, seed = 1, only = Vec::new(), gyro = false, first = 0, shard = None,
    threads = None, progress = None))]
#[expect(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn faults(
    py: Python<'_>,
    robot: Option<&Robot>,
    #[pyo3(from_py_with = arguments::runs)] runs: u64,
    #[pyo3(from_py_with = arguments::seed)] seed: u64,
    only: Vec<String>,
    gyro: bool,
    #[pyo3(from_py_with = arguments::first)] first: u64,
    #[pyo3(from_py_with = arguments::shard)] shard: Option<(usize, usize)>,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Campaign> {
    let robot = robot.map(|robot| (RobotFile::clone(&robot.file), PathBuf::new()));
    let on = Robots::of(robot, gyro).map_err(|e| error::argument("gyro", &e.to_string()))?;
    let parameters = Settings {
        on,
        runs,
        seed,
        only,
        first,
    };
    let (bases, all) = numbers(&parameters)?;
    let numbers = match shard {
        None => all.as_slice(),
        Some((index, count)) => part::shard(&all, index, count),
    };
    let total = numbers.len() as u64;
    let outcomes = work(py, threads, (progress, total), |progress| {
        // Run by run, so that it can be stopped between two: each is settled by seed and number alone.
        let run = |place: usize| {
            let one = [numbers[place]];
            progress.part(|| study(&bases, seed, one, &Mutation::None, || {}))
        };
        let runs: Result<Vec<Vec<Vec<_>>>, _> = part::in_pieces(0..numbers.len(), run).collect();
        runs.map(|runs| runs.into_iter().flatten().flatten().collect())
    })?;
    Ok(Campaign {
        parameters,
        outcomes: outcomes.map_err(|e| error::run(&e.to_string()))?,
    })
}
