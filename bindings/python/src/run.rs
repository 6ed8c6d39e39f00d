//! Runs: one or many.

use crate::figure::Figure;
use crate::mission::{Mission, law};
use crate::work::{Progress, work};
use crate::{arguments, error, sheet};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyIterator};
use sim_host::csv_out::{self, trace_sheet, unit};
use sim_host::drive::{DriveMetrics, summary};
use sim_host::figure::{Labelled, five_panels};
use sim_host::job::Job;
use sim_host::part::in_pieces;
use sim_host::record::{self, DriveRecord, Finished, Record};
use sim_host::run::{RunError, finish};
use sim_host::trace::{Trace, TraceRow};
use std::sync::Arc;

/// What came of a mission.
#[pyclass(module = "twb", frozen)]
pub struct Run {
    job: Arc<Job>,
    trace: Trace,
}

impl Run {
    pub const fn new(job: Arc<Job>, trace: Trace) -> Self {
        Self { job, trace }
    }

    /// Columns by their names.
    fn sheet(&self, wanted: &[&str]) -> csv_out::Sheet {
        trace_sheet(&self.trace, self.job.columns(), wanted)
    }

    /// As it stands in the file of the command line.
    fn record(&self) -> PyResult<String> {
        let no_rows = || error::run("the run has no ticks");
        let text = match &*self.job {
            Job::Scenario(scenario) => {
                let run = Finished::scenario(scenario, self.trace.clone()).ok_or_else(no_rows)?;
                record::text(&[Record::from(&run)])
            }
            Job::Mission { mission, file } => {
                let metrics = DriveMetrics::of(mission, &self.trace).ok_or_else(no_rows)?;
                let file = file.as_ref();
                record::text(&[DriveRecord::of(mission, file, &self.trace, &metrics, None)])
            }
        };
        text.map_err(|e| error::run(&e.to_string()))
    }

    /// Label in figures, as on the command line.
    fn label(&self) -> &'static str {
        match &*self.job {
            Job::Scenario(_) => law(&self.job),
            Job::Mission { .. } => "robot",
        }
    }
}

#[pymethods]
impl Run {
    #[getter]
    fn name(&self) -> &str {
        self.job.name()
    }

    #[getter]
    fn mission(&self) -> Mission {
        Mission {
            job: Arc::clone(&self.job),
        }
    }

    /// Names of the trace's columns, as in the CSV file.
    #[getter]
    fn columns(&self) -> Vec<&'static str> {
        self.job.columns().names()
    }

    /// Unit of each column.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for name in self.columns() {
            dict.set_item(name, unit(name))?;
        }
        Ok(dict)
    }

    /// An array for each column.
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        sheet::arrays(py, &self.sheet(&self.columns()))
    }

    /// One column.
    fn __getitem__<'py>(&self, py: Python<'py>, column: &str) -> PyResult<Bound<'py, PyAny>> {
        match self.sheet(&[column]).first() {
            Some((_, cells)) => sheet::array(py, cells),
            None => Err(pyo3::exceptions::PyKeyError::new_err(column.to_owned())),
        }
    }

    /// Whether there is such a column; other things than names are none.
    fn __contains__(&self, column: &Bound<'_, PyAny>) -> bool {
        let name = column.extract::<std::borrow::Cow<'_, str>>();
        name.is_ok_and(|name| self.columns().contains(&&*name))
    }

    /// Names of the columns, as of a table.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.columns().into_pyobject(py)?.try_iter()
    }

    /// Rows of each column.
    fn __len__(&self) -> usize {
        self.trace.rows.len()
    }

    /// The CSV file of the command line.
    #[pyo3(signature = (every = 1))]
    fn csv<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = arguments::every)] every: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        csv_out::write(&self.trace, self.job.columns(), every, &mut bytes)
            .map_err(|e| error::run(&e.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The JSON file of the command line.
    fn json(&self) -> PyResult<String> {
        self.record()
    }

    /// Figures of merit.
    #[getter]
    fn metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let records = sheet::json(py, &self.record()?)?;
        records.get_item(0)?.get_item("metrics")
    }

    /// What came of it, in a few lines for people.
    #[getter]
    fn summary(&self) -> PyResult<String> {
        let no_rows = || error::run("the run has no ticks");
        Ok(match &*self.job {
            Job::Mission { mission, .. } => {
                summary(&DriveMetrics::of(mission, &self.trace).ok_or_else(no_rows)?)
            }
            Job::Scenario(scenario) => {
                let run = Finished::scenario(scenario, self.trace.clone()).ok_or_else(no_rows)?;
                let column = sim_host::table::Column {
                    label: law(&self.job),
                    metrics: &run.metrics,
                };
                sim_host::table::side_by_side(&[column]).to_string()
            }
        })
    }

    /// Path, errors, speeds, torques; with another run below it.
    #[pyo3(signature = (other = None))]
    fn figure(&self, other: Option<PyRef<'_, Self>>) -> PyResult<Figure> {
        let main = Labelled {
            label: self.label(),
            trace: &self.trace,
        };
        let other = other.as_ref().map(|run| Labelled {
            label: run.label(),
            trace: &run.trace,
        });
        let drawing = five_panels(&self.job.title(), main, other);
        let drawing = drawing.map_err(|cause| error::run(&cause.to_string()))?;
        Ok(Figure::new(drawing))
    }

    fn _repr_svg_(&self) -> PyResult<String> {
        Ok(self.figure(None)?.into_svg())
    }

    fn __repr__(&self) -> String {
        let end = self.trace.rows.last().map_or(0.0, |row| row.t);
        format!(
            "<twb.Run {}: {} ticks, {end:.2} s>",
            self.job.name(),
            self.trace.rows.len()
        )
    }
}

/// The first error in the order of the missions, whichever came first in time.
fn in_order<T>(results: Vec<Result<T, RunError>>) -> PyResult<Vec<T>> {
    let all = results.into_iter().collect::<Result<Vec<T>, RunError>>();
    all.map_err(|e| error::run(&e.to_string()))
}

/// What comes of each, in order.
fn of_each<T: Send>(jobs: &[Arc<Job>], one: impl Fn(&Arc<Job>) -> T + Sync) -> Vec<T> {
    let pieces = in_pieces(0..jobs.len(), |place| one(&jobs[place]));
    pieces.flat_map(|piece: Vec<T>| piece).collect()
}

fn jobs(missions: &[PyRef<'_, Mission>]) -> Vec<Arc<Job>> {
    missions
        .iter()
        .map(|mission| Arc::clone(&mission.job))
        .collect()
}

/// Runs missions side by side; the results are in their order and do not depend on the number of threads.
#[pyfunction]
#[pyo3(signature = (missions, threads = None, progress = None))]
pub fn run_all(
    py: Python<'_>,
    missions: Vec<PyRef<'_, Mission>>,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Run>> {
    let jobs = jobs(&missions);
    let total = jobs.len() as u64;
    let results = work(py, threads, (progress, total), |progress| {
        // A run alone takes minutes as well.
        let one =
            |job: &Arc<Job>| progress.part(|| job.run_watched(Some(&mut |_| progress.obey())));
        of_each(&jobs, one)
    })?;
    let traces = in_order(results)?;
    let runs = jobs.into_iter().zip(traces);
    Ok(runs.map(|(job, trace)| Run::new(job, trace)).collect())
}

/// The end of a run.
struct Ended {
    last: TraceRow,
    ticks: usize,
    parked_since_s: Option<f64>,
}

fn ended(job: &Job, progress: &Progress) -> Result<Option<Ended>, RunError> {
    Ok(match job {
        Job::Mission { mission, .. } => {
            finish(mission, &mut || progress.obey())?.map(|finish| Ended {
                last: finish.last,
                ticks: finish.ticks,
                parked_since_s: finish.parked_since_s,
            })
        }
        Job::Scenario(_) => {
            let trace = job.run_watched(Some(&mut |_| progress.obey()))?;
            trace.rows.last().map(|last| Ended {
                last: *last,
                ticks: trace.rows.len(),
                parked_since_s: None,
            })
        }
    })
}

/// Runs missions side by side and keeps their last rows only: an array for each column, with an element for each
/// mission, beside `ticks` and `parked_s`.
#[pyfunction]
#[pyo3(signature = (missions, threads = None, progress = None))]
pub fn finish_all<'py>(
    py: Python<'py>,
    missions: Vec<PyRef<'py, Mission>>,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let jobs = jobs(&missions);
    let columns = jobs.first().map(|job| job.columns());
    if jobs.iter().any(|job| Some(job.columns()) != columns) {
        let message = "the paper's laws and the default one have other columns: run them apart";
        return Err(error::argument("missions", message));
    }
    let total = jobs.len() as u64;
    let results = work(py, threads, (progress, total), |progress| {
        let one = |job: &Arc<Job>| progress.part(|| ended(job, progress));
        of_each(&jobs, one)
    })?;
    let ends: Option<Vec<Ended>> = in_order(results)?.into_iter().collect();
    let ends = ends.ok_or_else(|| error::run("a run has no ticks"))?;
    let Some(columns) = columns else {
        return Ok(PyDict::new(py));
    };
    let trace = Trace {
        rows: ends.iter().map(|end| end.last).collect(),
        ..Trace::default()
    };
    let mut names = columns.names();
    // Of a whole trace, not of last rows.
    names.retain(|name| *name != "tick" && *name != "handed_over");
    let dict = sheet::arrays(py, &trace_sheet(&trace, columns, &names))?;
    let ticks = ends.iter().map(|end| end.ticks as u64);
    dict.set_item("ticks", PyArray1::from_iter(py, ticks))?;
    let parked = ends
        .iter()
        .map(|end| end.parked_since_s.unwrap_or(f64::NAN));
    dict.set_item("parked_s", PyArray1::from_iter(py, parked))?;
    Ok(dict)
}
