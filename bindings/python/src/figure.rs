//! Figures.

use crate::error;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// A figure: SVG, and PNG made of it. A notebook shows it.
#[pyclass(module = "twb", frozen)]
pub struct Figure {
    svg: String,
}

impl Figure {
    pub const fn new(svg: String) -> Self {
        Self { svg }
    }

    pub fn into_svg(self) -> String {
        self.svg
    }
}

#[pymethods]
impl Figure {
    /// As SVG.
    #[getter]
    fn svg(&self) -> &str {
        &self.svg
    }

    /// As PNG, with the font on board: the same pixels on every machine.
    #[getter]
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| sim_host::figure::png(&self.svg));
        let bytes = bytes.map_err(|cause| error::run(&cause.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn _repr_svg_(&self) -> &str {
        &self.svg
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.png(py)
    }

    fn __repr__(&self) -> String {
        format!("<twb.Figure, {} bytes of SVG>", self.svg.len())
    }
}
