//! The base files that travel inside the program.

use super::ScenarioError;
use super::built_in::unless_file;
use crate::mission::BaseSpec;
use std::path::Path;

/// A base file built into the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltInBase {
    /// Its name on the command line and in scenarios.
    pub name: &'static str,
    /// The file, comments included.
    pub text: &'static str,
}

macro_rules! bases {
    ($($name:literal),*) => {
        /// The files of `bases/`.
        pub const BASES: &[BuiltInBase] = &[$(BuiltInBase {
            name: $name,
            text: include_str!(concat!("../../../bases/", $name, ".toml")),
        }),*];
    };
}

bases!["paper-30kg", "lab-10kg", "hobby-1kg"];

/// A gyro for any of them: the file `parts/icm-42688-p.toml`, which is appended to a base's.
pub const GYRO: &str = include_str!("../../../parts/icm-42688-p.toml");

/// Drivers with a speed loop for any of them: `parts/speed-driver.toml`, likewise.
pub const SPEED_DRIVER: &str = include_str!("../../../parts/speed-driver.toml");

impl BuiltInBase {
    /// The built-in base of this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        BASES.iter().find(|base| base.name == name)
    }

    /// The built-in base that a path names. A file of that name comes first, a directory does not.
    pub fn at(path: &Path) -> Option<&'static Self> {
        unless_file(path.to_str().and_then(Self::find), path)
    }

    /// Reads it like any other file.
    ///
    /// # Errors
    /// As [`BaseSpec::parse`]; a test reads them all.
    pub fn base(&self) -> Result<BaseSpec, ScenarioError> {
        BaseSpec::parse(&format!("{}.toml", self.name), self.text)
    }

    /// The same with [`GYRO`].
    ///
    /// # Errors
    /// As [`BaseSpec::parse`].
    pub fn with_gyro(&self) -> Result<BaseSpec, ScenarioError> {
        self.with(GYRO)
    }

    /// The base with [`SPEED_DRIVER`].
    ///
    /// # Errors
    /// As [`BaseSpec::parse`].
    pub fn with_speed_driver(&self) -> Result<BaseSpec, ScenarioError> {
        self.with(SPEED_DRIVER)
    }

    fn with(&self, part: &str) -> Result<BaseSpec, ScenarioError> {
        let text = format!("{}\n{part}", self.text);
        BaseSpec::parse(&format!("{}.toml", self.name), &text)
    }
}

#[cfg(test)]
mod tests {
    use super::BASES;

    #[test]
    fn all_are_read_and_have_hardware() {
        for built_in in BASES {
            let base = built_in.base().unwrap_or_else(|error| panic!("{error}"));
            assert!(base.hardware.is_some(), "{}", built_in.name);
        }
    }
}
