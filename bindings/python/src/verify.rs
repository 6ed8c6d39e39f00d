//! Does a robot do its courses on bad floors?

use crate::robot::{Robot, figures};
use crate::run::Run;
use crate::work::work;
use crate::{arguments, error, sheet};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sim_host::job::{Job, RobotFile};
use sim_host::verify::{
    Verification as Found, check, report, run_sheet, runs, verify as study, write_csv,
};
use std::num::NonZeroU32;
use std::sync::Arc;

/// All runs of a robot on bad floors.
#[pyclass(module = "twb", frozen)]
pub struct Verification {
    found: Found,
    robot: Arc<RobotFile>,
    /// Of the first world.
    seed: u64,
}

#[pymethods]
impl Verification {
    /// Every run did all that is asked.
    #[getter]
    fn passed(&self) -> bool {
        self.found.holds()
    }

    /// An array for each column of the CSV file.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        sheet::arrays(py, &run_sheet(&self.found.runs))
    }

    /// A dictionary for each course and condition.
    #[getter]
    fn cases<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        figures(py, &self.found.cases)
    }

    /// The CSV file of the command line.
    fn csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        write_csv(&self.found.runs, &mut bytes).map_err(|e| error::run(&e.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// What the command line prints: table, verdict, how stable the robot follows.
    #[getter]
    fn report(&self, py: Python<'_>) -> String {
        py.detach(|| report(&self.robot.base, &self.found, self.seed))
    }

    /// The worst run again, with its trace.
    fn worst(&self, py: Python<'_>) -> PyResult<Run> {
        let worst = self.found.worst().ok_or_else(|| error::run("no runs"))?;
        let trace = py.detach(|| worst.again(&self.robot.base));
        let trace = trace.map_err(|e| error::run(&e.to_string()))?;
        let mission = worst.course.mission(&self.robot.base);
        let job = Job::Mission {
            mission: Box::new(mission),
            file: None,
        };
        Ok(Run::new(Arc::new(job), trace))
    }

    fn __repr__(&self) -> String {
        let robot = &self.robot.name;
        format!("<twb.Verification of {robot}: {}>", self.found.failures())
    }
}

/// Runs every course under every condition, `seeds` times each with seeds `seed`, `seed` + 1, ...
#[pyfunction]
#[pyo3(signature = (robot, seeds, seed = 1, threads = None, progress = None))]
pub fn verify(
    py: Python<'_>,
    robot: &Robot,
    #[pyo3(from_py_with = arguments::seeds)] seeds: NonZeroU32,
    #[pyo3(from_py_with = arguments::seed)] seed: u64,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Verification> {
    check(&robot.file).map_err(|e| error::scenario(&e))?;
    let base = &robot.file.base;
    let found = work(py, threads, (progress, runs(seeds)), |progress| {
        study(base, seed, seeds, || progress.begin())
    })?;
    Ok(Verification {
        found: found.map_err(|e| error::run(&e.to_string()))?,
        robot: Arc::clone(&robot.file),
        seed,
    })
}
