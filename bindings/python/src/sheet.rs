//! Tables as dictionaries of arrays.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use sim_host::csv_out::{Cell, Kind, Sheet};

/// An array for each column, in order.
pub fn arrays<'py>(py: Python<'py>, sheet: &Sheet) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, cells) in sheet {
        dict.set_item(name, array(py, cells)?)?;
    }
    Ok(dict)
}

/// Floats, whole numbers, flags or words, as the column has them. Where nothing stands: not a number, or an empty word.
pub fn array<'py>(py: Python<'py>, cells: &[Cell]) -> PyResult<Bound<'py, PyAny>> {
    let whole = cells.iter().all(|cell| matches!(cell, Cell::Whole(_)));
    let flags = cells.iter().all(|cell| matches!(cell, Cell::Flag(_)));
    Ok(match cells.first().map_or(Kind::Number, Cell::kind) {
        Kind::Whole if whole => {
            let numbers = cells.iter().map(|cell| match cell {
                Cell::Whole(number) => *number,
                _ => 0,
            });
            PyArray1::from_iter(py, numbers).into_any()
        }
        Kind::Flag if flags => {
            let flags = cells.iter().map(|cell| *cell == Cell::Flag(true));
            PyArray1::from_iter(py, flags).into_any()
        }
        Kind::Text => words(py, cells.iter().map(ToString::to_string))?,
        Kind::Number | Kind::Whole | Kind::Flag => {
            PyArray1::from_iter(py, cells.iter().map(number)).into_any()
        }
    })
}

/// Words as an array of strings.
pub fn words<'py>(
    py: Python<'py>,
    words: impl ExactSizeIterator<Item = String>,
) -> PyResult<Bound<'py, PyAny>> {
    let list = PyList::new(py, words)?;
    py.import("numpy")?.call_method1("array", (list, "str"))
}

fn number(cell: &Cell) -> f64 {
    match cell {
        Cell::Number(number) | Cell::Scientific(number) | Cell::Fixed(number) => *number,
        Cell::Single(number) => f64::from(*number),
        Cell::Whole(number) => *number as f64,
        Cell::Flag(flag) => f64::from(u8::from(*flag)),
        Cell::Nothing(_) | Cell::Text(_) => f64::NAN,
    }
}

/// What a JSON text says.
pub fn json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
