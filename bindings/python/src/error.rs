//! Errors of the library as exceptions of the package, with file, line and key.

use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use sim_host::drive::FileError;
use sim_host::identify::LogError;
use sim_host::import::Refusal;
use sim_host::job::JobError;
use sim_host::scenario::ScenarioError;
use std::path::Path;

/// Which exception of `twb.errors`.
#[derive(Clone, Copy)]
enum Kind {
    /// A file or an argument that cannot be used.
    Input,
    /// A file that is not there.
    Missing,
    /// A run that did not reach its end.
    Run,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Input => "InputError",
            Self::Missing => "MissingFileError",
            Self::Run => "RunError",
        }
    }
}

/// Where an error is, as far as it is known.
#[derive(Default)]
struct Place {
    file: Option<String>,
    line: Option<usize>,
    key: Option<String>,
}

/// The exceptions are written in Python, where several parents are no trouble.
fn exception(kind: Kind, message: &str, place: Place) -> PyErr {
    Python::attach(|py| {
        let made = || -> PyResult<PyErr> {
            let class = py.import("twb.errors")?.getattr(kind.name())?;
            let arguments = [
                ("file", place.file.into_pyobject(py)?.into_any()),
                ("line", place.line.into_pyobject(py)?.into_any()),
                ("key", place.key.into_pyobject(py)?.into_any()),
            ];
            let arguments = arguments.into_py_dict(py)?;
            let value = class.call_method("at", (message,), Some(&arguments))?;
            Ok(PyErr::from_value(value))
        };
        made().unwrap_or_else(|error| error)
    })
}

fn named(path: &Path) -> Option<String> {
    Some(path.display().to_string())
}

/// Of a file that cannot be read at all.
pub fn unreadable(path: &Path, cause: &std::io::Error) -> PyErr {
    let kind = match cause.kind() {
        std::io::ErrorKind::NotFound => Kind::Missing,
        _ => Kind::Input,
    };
    let message = format!("{}: cannot be read: {cause}", path.display());
    let place = Place {
        file: named(path),
        ..Place::default()
    };
    exception(kind, &message, place)
}

/// Of a scenario or a robot's file.
pub fn scenario(error: &ScenarioError) -> PyErr {
    let place = Place {
        file: Some(error.file.clone()),
        line: error.line,
        key: Some(error.key.clone()).filter(|key| !key.is_empty()),
    };
    exception(Kind::Input, &error.to_string(), place)
}

/// Of a trajectory's file.
pub fn trajectory(path: &Path, error: &FileError) -> PyErr {
    match error {
        FileError::Refused(refusal) => refused(path, refusal),
        FileError::Option(option, ..) => {
            // The command line's options have no units.
            let key = match *option {
                "period" => "period_s".to_owned(),
                option => format!("{option}_m"),
            };
            argument(&key, &error.to_string().replacen(option, &key, 1))
        }
        other => {
            let place = Place {
                file: named(path),
                ..Place::default()
            };
            exception(Kind::Input, &format!("{}: {other}", path.display()), place)
        }
    }
}

/// Of a trajectory's file that cannot be driven.
pub fn refused(path: &Path, refusal: &Refusal) -> PyErr {
    let place = Place {
        file: named(path),
        line: refusal.place.line,
        key: refusal.place.field.clone(),
    };
    exception(
        Kind::Input,
        &format!("{}: {refusal}", path.display()),
        place,
    )
}

/// Of what was named to be run.
pub fn job(error: &JobError) -> PyErr {
    match error {
        JobError::Scenario(cause) => scenario(cause),
        JobError::Read { path, cause } => unreadable(path, cause),
        JobError::Trajectory { path, cause } => trajectory(path, cause),
        other => exception(Kind::Input, &other.to_string(), Place::default()),
    }
}

/// Of a log.
pub fn log(path: &Path, error: &LogError) -> PyErr {
    let (line, key) = match error {
        LogError::Cell { line, column, .. } => (Some(*line), Some(column.clone())),
        LogError::Columns(line, _) => (Some(*line), None),
        LogError::Csv(refusal) => return refused(path, refusal),
        LogError::CountsPerTurn => (None, Some("counts_per_turn".to_owned())),
        LogError::Short(_) => (None, None),
    };
    let place = Place {
        file: named(path),
        line,
        key,
    };
    exception(Kind::Input, &format!("{}: {error}", path.display()), place)
}

/// Of what a file says as a whole.
pub fn content(path: &Path, message: &str) -> PyErr {
    let place = Place {
        file: named(path),
        ..Place::default()
    };
    exception(
        Kind::Input,
        &format!("{}: {message}", path.display()),
        place,
    )
}

/// Of an argument.
pub fn argument(key: &str, message: &str) -> PyErr {
    let place = Place {
        key: Some(key.to_owned()),
        ..Place::default()
    };
    exception(Kind::Input, message, place)
}

/// Of a run.
pub fn run(message: &str) -> PyErr {
    exception(Kind::Run, message, Place::default())
}
