//! Trajectory files.

use crate::error;
use crate::robot::{Robot, numbers};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sim_host::drive::{Retiming, trajectory};
use sim_host::import::{FileVerdict, Pace, Sample, Trajectory as Reference};
use sim_host::mission::BaseSpec;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A trajectory file as a reference that a wheeled base can follow.
#[pyclass(module = "twb", frozen)]
pub struct Trajectory {
    pub name: String,
    /// The file's own content: what a mission is made of.
    pub bytes: Arc<Vec<u8>>,
    reference: Arc<Reference>,
}

impl Trajectory {
    pub fn of(path: &Path, bytes: Vec<u8>, tolerance_m: Option<f64>) -> PyResult<Self> {
        let stem = path.file_stem().unwrap_or_default();
        let retiming = retiming(false, tolerance_m);
        retiming.check().map_err(|e| error::trajectory(path, &e))?;
        let reference =
            trajectory(&bytes, &retiming).map_err(|refusal| error::refused(path, &refusal))?;
        Ok(Self {
            name: stem.to_string_lossy().into_owned(),
            bytes: Arc::new(bytes),
            reference: Arc::new(reference),
        })
    }
}

/// A column of samples.
type Column = (&'static str, fn(&Sample) -> f64);

/// An array for each column of samples.
fn columns<'py>(py: Python<'py>, samples: &[Sample]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let columns: [Column; 9] = [
        ("t", |s| s.t),
        ("x", |s| s.x),
        ("y", |s| s.y),
        ("theta", |s| s.theta),
        ("v", |s| s.v),
        ("w", |s| s.w),
        ("a", |s| s.a),
        ("alpha", |s| s.alpha),
        ("left", |s| s.left),
    ];
    for (name, value) in columns {
        dict.set_item(name, PyArray1::from_iter(py, samples.iter().map(value)))?;
    }
    Ok(dict)
}

#[pymethods]
impl Trajectory {
    /// Reads a file. Poses that no wheeled base passes, as of noise, may be missed by `tolerance_m`.
    #[staticmethod]
    #[pyo3(signature = (path, *, tolerance_m = None))]
    fn load(path: PathBuf, tolerance_m: Option<f64>) -> PyResult<Self> {
        let bytes = std::fs::read(&path).map_err(|cause| error::unreadable(&path, &cause))?;
        Self::of(&path, bytes, tolerance_m)
    }

    /// A trajectory from the content of its file; `file` is the name that errors show.
    #[staticmethod]
    #[pyo3(signature = (content, file = "trajectory", *, tolerance_m = None))]
    fn parse(content: Vec<u8>, file: &str, tolerance_m: Option<f64>) -> PyResult<Self> {
        Self::of(Path::new(file), content, tolerance_m)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn format(&self) -> String {
        self.reference.source().to_string()
    }

    #[getter]
    fn duration_s(&self) -> f64 {
        self.reference.duration()
    }

    /// Peak values.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let figures = self.reference.figures();
        let values = [
            ("duration_s", figures.duration_s),
            ("length_m", figures.length_m),
            ("fastest_m_s", figures.speed_m_s.0),
            ("slowest_m_s", figures.speed_m_s.1),
            ("turn_rate_rad_s", figures.turn_rate),
            ("accel_m_s2", figures.accel),
            ("angular_accel_rad_s2", figures.angular_accel),
            ("lateral_accel_m_s2", figures.lateral_accel),
            ("curvature_per_m", figures.curvature),
        ];
        numbers(py, values)
    }

    /// What had to be repaired, one line each.
    #[getter]
    fn repairs(&self) -> Vec<String> {
        let repairs = self.reference.repairs().iter();
        repairs.map(ToString::to_string).collect()
    }

    /// How close the reference passes the poses of the file [m, rad].
    #[getter]
    fn closeness(&self) -> (f64, f64) {
        let close = self.reference.closeness();
        (close.position_m, close.heading_rad)
    }

    /// Format, figures and repairs, for people.
    #[getter]
    fn report(&self) -> String {
        FileVerdict(Ok(&self.reference)).to_string()
    }

    /// An array for each of t, x, y, theta, v, w, a, alpha and left, what the last drive has to go until it rests; at most 25 ms between samples.
    #[getter]
    fn samples<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, self.reference.samples())
    }

    /// The same at any times, an array or a list.
    fn at<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
        let wrong = |what: &str| error::argument("times", &format!("times must be {what}"));
        // By numpy itself, as anything else in Python would take it.
        let array = py.import("numpy")?.call_method1("asarray", (times, "d"));
        let array = array.and_then(|array| array.extract::<PyReadonlyArray1<'py, f64>>());
        let array = array.map_err(|_| wrong("an array or a list of numbers, one axis"))?;
        let times = array.as_array();
        if times.iter().any(|t| t.is_nan()) {
            return Err(wrong("numbers, and one is NaN"));
        }
        let samples: Vec<Sample> = times.iter().map(|t| self.reference.at(*t)).collect();
        columns(py, &samples)
    }

    /// What a robot makes of it: the fastest within its limits and within `tolerance_m` of the path, else nowhere
    /// faster than the file. Also how its time was scaled, for people.
    #[pyo3(signature = (robot = None, *, fastest = false, tolerance_m = None))]
    fn scaled(
        &self,
        py: Python<'_>,
        robot: Option<&Robot>,
        fastest: bool,
        tolerance_m: Option<f64>,
    ) -> PyResult<(Self, String)> {
        let base = robot.map_or_else(BaseSpec::default, |robot| robot.file.base.clone());
        let retiming = retiming(fastest, tolerance_m);
        let scaled = py.detach(|| retiming.of(&self.reference, &base));
        let (reference, scaling) =
            scaled.map_err(|e| error::trajectory(Path::new(&self.name), &e))?;
        let scaled = Self {
            name: self.name.clone(),
            bytes: Arc::clone(&self.bytes),
            reference: Arc::new(reference),
        };
        Ok((scaled, scaling.to_string()))
    }

    fn __repr__(&self) -> String {
        let (name, figures) = (&self.name, self.reference.figures());
        format!(
            "<twb.Trajectory {name}: {}, {:.2} s, {:.2} m>",
            self.format(),
            figures.duration_s,
            figures.length_m
        )
    }
}

/// How a trajectory becomes the reference of a base.
pub fn retiming(fastest: bool, tolerance_m: Option<f64>) -> Retiming {
    let usual = Retiming::default();
    Retiming {
        pace: if fastest { Pace::Fastest } else { Pace::Own },
        tolerance_m: tolerance_m.unwrap_or(usual.tolerance_m),
    }
}
