//! Gains for a robot, searched.

use crate::robot::{Robot, figures, gains, numbers};
use crate::trajectory::Trajectory;
use crate::work::work;
use crate::{arguments, error};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sim_host::tune::{Search, Tuned as Found, TuningProblem, check, report, search};
use std::path::Path;

/// What came of a search; of each pair the first is before.
#[pyclass(module = "twb", frozen)]
pub struct Tuned {
    found: Found,
    robot: Py<Robot>,
}

type Pair<'py, T> = (Bound<'py, T>, Bound<'py, T>);

#[pymethods]
impl Tuned {
    /// The robot with the new gains, in its text as well.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<Robot> {
        self.robot.clone_ref(py)
    }

    #[getter]
    fn gains<'py>(&self, py: Python<'py>) -> PyResult<Pair<'py, PyDict>> {
        let [before, after] = &self.found.gains;
        Ok((numbers(py, gains(before))?, numbers(py, gains(after))?))
    }

    /// Parts of the score in the worlds of the search; the smaller the better.
    #[getter]
    fn training<'py>(&self, py: Python<'py>) -> PyResult<Pair<'py, PyAny>> {
        let [before, after] = &self.found.training;
        Ok((figures(py, before)?, figures(py, after)?))
    }

    /// The same in worlds that it did not see.
    #[getter]
    fn unseen<'py>(&self, py: Python<'py>) -> PyResult<Pair<'py, PyAny>> {
        let [before, after] = &self.found.unseen;
        Ok((figures(py, before)?, figures(py, after)?))
    }

    /// The sums of the last: before, after.
    #[getter]
    fn scores(&self) -> (f64, f64) {
        let [before, after] = &self.found.unseen;
        (before.total(), after.total())
    }

    /// What the command line prints: tables, verdict, least damping; its warning, if there is one, is the last line.
    #[getter]
    fn report(&self, py: Python<'_>) -> String {
        let base = &self.robot.get().file.base;
        let (text, warning) = py.detach(|| report(base, &self.found));
        match warning {
            Some(warning) => format!("{text}\nwarning: {warning}"),
            None => text,
        }
    }

    fn __repr__(&self) -> String {
        let (before, after) = self.scores();
        format!("<twb.Tuned: {before:.3} to {after:.3} points in unseen worlds>")
    }
}

/// Searches gains on bad floors: for the paper's line and curve and a park, or for a trajectory file and a park.
#[pyfunction]
#[pyo3(signature = (robot, trajectory = None, evaluations = 240, seed = 1, threads = None, progress = None))]
pub fn tune(
    py: Python<'_>,
    robot: &Robot,
    trajectory: Option<&Trajectory>,
    #[pyo3(from_py_with = arguments::evaluations)] evaluations: u64,
    #[pyo3(from_py_with = arguments::seed)] seed: u64,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Tuned> {
    check(&robot.file).map_err(|e| error::scenario(&e))?;
    let base = &robot.file.base;
    let problem = match trajectory {
        None => TuningProblem::courses(base),
        Some(trajectory) => {
            let (name, bytes) = (&trajectory.name, &trajectory.bytes);
            let problem = py.detach(|| TuningProblem::trajectory(base, name, bytes));
            problem
                .map_err(|e| error::trajectory(Path::new(name), &e))?
                .0
        }
    };
    let how = Search {
        evaluations,
        seed,
        ..Search::default()
    };
    let found = work(py, threads, (progress, evaluations), |progress| {
        search(&problem, &how, || progress.begin())
    })?;
    let found = found.map_err(|e| error::run(&e.to_string()))?;
    let robot = Py::new(py, robot.with(&found.gains[1])?)?;
    Ok(Tuned { found, robot })
}
