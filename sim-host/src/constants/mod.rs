//! A robot as constants for a firmware: a Rust file with every parameter of
//! [`controller_core::base::BaseParams`], in the simulator's very numbers.
//!
//! ```
//! use sim_host::constants::rust;
//! use sim_host::scenario::BuiltInBase;
//!
//! let base = BuiltInBase::find("lab-10kg").ok_or("not built in")?.base()?;
//! let text = rust("lab-10kg.toml", &base).map_err(|error| error.to_string())?;
//! assert!(text.contains("pub const BASE: BaseParams<f32>") && text.contains("mass_kg: 10.0,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod parts;
mod writer;

use crate::closed_loop;
use crate::mission::BaseSpec;
use controller_core::error::ParamError;
use writer::Writer;

/// The module's name: the file's, in what Rust takes for one.
pub fn module_name(name: &str) -> String {
    let letters = name.chars().map(|c| match c {
        'a'..='z' | '0'..='9' => c,
        'A'..='Z' => c.to_ascii_lowercase(),
        _ => '_',
    });
    let mut name: String = letters.collect();
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        name.insert_str(0, "robot_");
    }
    name
}

/// The control period \[µs\].
pub fn period_us(base: &BaseSpec) -> u32 {
    (1.0e6 * base.period_s()).round() as u32
}

/// The file: `PERIOD_US` and `BASE`, as rustfmt leaves it. `source` is the name of the robot's file.
///
/// # Errors
/// Parameters that the core refuses.
pub fn rust(source: &str, base: &BaseSpec) -> Result<String, ParamError> {
    let period_us = period_us(base);
    let params = closed_loop::params(base, period_us)?;
    let mut out = Writer::new();
    // A name goes into comments: on one line, and in no sentence, whatever its grammar.
    let name = base.name.replace(['\n', '\r'], " ");
    out.line(&format!("//! Robot constants: {name}"));
    out.line("//!");
    out.line(&format!(
        "//! Made by `sim-host constants` from `{source}`: change that file, not this one. SI units, radians."
    ));
    out.line("");
    parts::imports(&mut out, &params);
    out.line("");
    out.line("/// Time between ticks \\[µs\\].");
    out.line(&format!(
        "pub const PERIOD_US: u32 = {};",
        writer::whole(period_us)
    ));
    out.line("");
    out.line(&format!("/// All parameters: {name}"));
    out.open("pub const BASE: BaseParams<f32> = BaseParams {");
    parts::base(&mut out, &params);
    out.close("};");
    Ok(out.text())
}
