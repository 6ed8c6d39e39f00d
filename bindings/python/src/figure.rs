//! Figures.

use crate::error;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sim_host::figure::Drawing;

/// A figure, as SVG and as PNG. A notebook shows it.
#[pyclass(module = "twb", frozen)]
pub struct Figure {
    drawing: Drawing,
    svg: String,
}

impl Figure {
    pub fn new(drawing: Drawing) -> Self {
        let svg = drawing.svg();
        Self { drawing, svg }
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
        let bytes = py.detach(|| self.drawing.png());
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
