//! The extension module behind the Python package `twb`.
//!
//! It converts and runs side by side; what it runs is [`sim_host`]'s. Long work goes through `work`: the GIL is
//! released, every core used, progress reported and Ctrl-C obeyed. Tables become arrays in `sheet`, errors exceptions
//! in `error`.

mod arguments;
mod error;
mod faults;
mod figure;
mod fleet;
mod identify;
mod mission;
mod robot;
mod run;
mod sheet;
mod trajectory;
mod tune;
mod verify;
mod work;

use pyo3::prelude::*;
use sim_host::scenario::{BASES, BUILT_IN, MISSIONS};

/// What `twb` is made of.
#[pymodule(gil_used = false)]
fn _twb(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    let robots: Vec<&str> = BASES.iter().map(|built_in| built_in.name).collect();
    module.add("ROBOTS", pyo3::types::PyTuple::new(module.py(), robots)?)?;
    let scenarios = BUILT_IN
        .iter()
        .chain(MISSIONS)
        .map(|built_in| built_in.name);
    let scenarios: Vec<&str> = scenarios.collect();
    module.add(
        "SCENARIOS",
        pyo3::types::PyTuple::new(module.py(), scenarios)?,
    )?;
    module.add_class::<robot::Robot>()?;
    module.add_class::<trajectory::Trajectory>()?;
    module.add_class::<mission::Mission>()?;
    module.add_class::<run::Run>()?;
    module.add_class::<figure::Figure>()?;
    module.add_class::<tune::Tuned>()?;
    module.add_class::<verify::Verification>()?;
    module.add_class::<identify::Identification>()?;
    module.add_class::<faults::Campaign>()?;
    module.add_class::<fleet::Fleet>()?;
    module.add_function(wrap_pyfunction!(run::run_all, module)?)?;
    module.add_function(wrap_pyfunction!(run::finish_all, module)?)?;
    module.add_function(wrap_pyfunction!(tune::tune, module)?)?;
    module.add_function(wrap_pyfunction!(verify::verify, module)?)?;
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(faults::faults, module)?)?;
    Ok(())
}
