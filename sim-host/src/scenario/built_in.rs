//! The scenario files that travel inside the program.

use super::{Scenario, ScenarioError};
use std::path::Path;

/// A scenario file built into the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltIn {
    /// Its name on the command line.
    pub name: &'static str,
    /// The file, comments included.
    pub text: &'static str,
}

macro_rules! built_in {
    ($(#[$doc:meta])* $list:ident: $($name:literal),* $(,)?) => {
        $(#[$doc])*
        pub const $list: &[BuiltIn] = &[$(BuiltIn {
            name: $name,
            text: include_str!(concat!("../../../scenarios/", $name, ".toml")),
        }),*];
    };
}

built_in![
    /// The files of `scenarios/` with a controller of the paper.
    BUILT_IN:
    "paper-line",
    "paper-curve",
    "moving-start",
    "standing-reference",
    "unequal-gains",
    "wrong-robot",
    "weaving",
];

built_in![
    /// The files of `scenarios/` with the law for a real base: [`crate::mission::Mission`]s.
    MISSIONS:
    "park-beside",
    "start-from-rest",
    "reverse",
    "turn-in-place",
    "heading-pi",
    "weak-base",
    "retarget",
    "back-to-tracking",
    "drive-and-park",
    "fast",
    "bad-floor-line",
    "bad-floor-curve",
];

/// The paper's two cases, Figs. 3 and 4.
pub const PAPER: [&str; 2] = ["paper-line", "paper-curve"];

/// What is built in under a name, where the name's `path` leads to nothing to read: a file comes first, a pipe too, a directory does not.
pub(super) fn unless_file<T>(built_in: Option<T>, path: &Path) -> Option<T> {
    built_in.filter(|_| !path.exists() || path.is_dir())
}

impl BuiltIn {
    /// The built-in scenario of this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        let mut all = BUILT_IN.iter().chain(MISSIONS);
        all.find(|built_in| built_in.name == name)
    }

    /// The built-in scenario that a path names. A file of that name comes first, a directory does not.
    pub fn at(path: &Path) -> Option<&'static Self> {
        unless_file(path.to_str().and_then(Self::find), path)
    }

    /// Reads it like any other file.
    ///
    /// # Errors
    /// As [`Scenario::parse`]; a test reads them all.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::parse(&format!("{}.toml", self.name), self.text)
    }
}
