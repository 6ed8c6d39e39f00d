//! A robot, as its file has it.

use crate::{error, sheet};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sim_host::advice::{Advice, of_base};
use sim_host::constants;
use sim_host::job::RobotFile;
use sim_host::mission::BaseSpec;
use sim_host::tune::{KNOBS, update};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A robot, as its file has it.
#[pyclass(module = "twb", frozen)]
pub struct Robot {
    pub file: Arc<RobotFile>,
}

impl Robot {
    /// The robot of a file with other text.
    fn with_text(&self, text: String) -> PyResult<Self> {
        let base = BaseSpec::parse(&self.file.file, &text).map_err(|e| error::scenario(&e))?;
        let file = RobotFile {
            base,
            text,
            ..RobotFile::clone(&self.file)
        };
        Ok(Self {
            file: Arc::new(file),
        })
    }

    /// The same robot with other gains, in its text as well.
    pub fn with(&self, gains: &controller_core::motion::MotionGains<f64>) -> PyResult<Self> {
        let text = update(&self.file.text, gains);
        self.with_text(
            text.map_err(|e| error::content(Path::new(&self.file.file), &e.to_string()))?,
        )
    }
}

/// The gains that can be set.
pub fn gains(gains: &controller_core::motion::MotionGains<f64>) -> Vec<(&'static str, f64)> {
    KNOBS
        .iter()
        .map(|knob| (knob.key, knob.of(gains)))
        .collect()
}

/// A dictionary of numbers, in order.
pub fn numbers<'py>(
    py: Python<'py>,
    values: impl IntoIterator<Item = (&'static str, f64)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in values {
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

/// Sentences for people.
pub fn texts(advice: &[Advice]) -> Vec<String> {
    advice.iter().map(|a| a.text().to_owned()).collect()
}

#[pymethods]
impl Robot {
    /// A file if there is one, else a shipped robot of that name.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let file = RobotFile::load(&path).map_err(|e| error::job(&e))?;
        Ok(Self {
            file: Arc::new(file),
        })
    }

    /// A robot from the text of its file; `file` is the name that errors show.
    #[staticmethod]
    #[pyo3(signature = (text, file = "robot.toml"))]
    fn parse(text: String, file: &str) -> PyResult<Self> {
        let base = BaseSpec::parse(file, &text).map_err(|e| error::scenario(&e))?;
        let stem = Path::new(file).file_stem().unwrap_or_default();
        let file = RobotFile {
            name: stem.to_string_lossy().into_owned(),
            file: file.to_owned(),
            text,
            base,
        };
        Ok(Self {
            file: Arc::new(file),
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.file.name
    }

    #[getter]
    fn description(&self) -> &str {
        &self.file.base.name
    }

    #[getter]
    fn text(&self) -> &str {
        &self.file.text
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.file.base.notes.clone()
    }

    /// What a user should know before the robot finds out, notes included.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        texts(&of_base(&self.file.base))
    }

    #[getter]
    fn period_s(&self) -> f64 {
        self.file.base.period_s()
    }

    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let limits = &self.file.base.limits;
        let values = [
            ("speed", limits.speed),
            ("turn_rate", limits.turn_rate),
            ("rim_speed", limits.rim_speed),
            ("accel", limits.accel),
            ("brake", limits.brake),
            ("turn_accel", limits.turn_accel),
            ("jerk", limits.jerk),
            ("turn_jerk", limits.turn_jerk),
            ("wheel_torque", limits.wheel_torque_nm),
        ];
        numbers(py, values)
    }

    #[getter]
    fn gains<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        numbers(py, gains(&self.file.base.motion().gains))
    }

    /// The same robot with other gains; its text has them too.
    fn with_gains(&self, gains: BTreeMap<String, f64>) -> PyResult<Self> {
        let mut all = self.file.base.motion().gains;
        for (key, value) in gains {
            match KNOBS.iter().find(|knob| knob.key == key) {
                // Refused, not brought into its range in silence.
                Some(knob) => {
                    knob.put(&mut all, value);
                    if knob.of(&all) != value {
                        let message = format!("gains.{key}: {value:?} is out of its range");
                        return Err(error::argument(&key, &message));
                    }
                }
                None => {
                    let names: Vec<_> = KNOBS.iter().map(|knob| knob.key).collect();
                    let message = format!("no gain is named {key}: there are {}", names.join(", "));
                    return Err(error::argument(&key, &message));
                }
            }
        }
        self.with(&all)
    }

    /// The robot's constants for a firmware, in Rust or C.
    #[pyo3(signature = (language = "rust"))]
    fn constants(&self, language: &str) -> PyResult<String> {
        let RobotFile {
            name, file, base, ..
        } = &*self.file;
        let text = match language {
            "rust" => constants::rust(file, base),
            "c" => constants::c_header(file, name, base),
            other => {
                let message = format!("language is {other}: it must be rust or c");
                return Err(error::argument("language", &message));
            }
        };
        text.map_err(|e| error::content(Path::new(file), &e.to_string()))
    }

    /// For pickle.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let parse = py.get_type::<Self>().getattr("parse")?;
        // The name is the stem of the file.
        let file = format!("{}.toml", self.file.name);
        Ok((parse, (self.file.text.clone(), file)))
    }

    fn __repr__(&self) -> String {
        format!("<twb.Robot {}: {}>", self.file.name, self.file.base.name)
    }
}

/// What a JSON text of figures says.
pub fn figures<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| error::run(&e.to_string()))?;
    sheet::json(py, &text)
}
