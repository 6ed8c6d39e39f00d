//! The scenario files that travel inside the program.

use super::{Scenario, ScenarioError};

/// A scenario file built into the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltIn {
    /// Its name on the command line.
    pub name: &'static str,
    /// The file, comments included.
    pub text: &'static str,
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// All files of `scenarios/`.
        pub const BUILT_IN: &[BuiltIn] = &[$(BuiltIn {
            name: $name,
            text: include_str!(concat!("../../../scenarios/", $name, ".toml")),
        }),*];
    };
}

built_in![
    "paper-line",
    "paper-curve",
    "moving-start",
    "standing-reference",
    "unequal-gains",
    "wrong-robot",
    "weaving",
];

/// The paper's two cases, Figs. 3 and 4.
pub const PAPER: [&str; 2] = ["paper-line", "paper-curve"];

impl BuiltIn {
    /// The built-in scenario of this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        BUILT_IN.iter().find(|built_in| built_in.name == name)
    }

    /// Reads it like any other file.
    ///
    /// # Errors
    /// As [`Scenario::parse`]; a test reads them all.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::parse(&format!("{}.toml", self.name), self.text)
    }
}
