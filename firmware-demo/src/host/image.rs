//! Builds firmware for an emulated board.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::string::String;
use std::{env, io};

use super::Machine;

/// What to build.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    /// For which machine.
    pub machine: Machine,
    /// Which binary of this package.
    pub bin: &'a str,
    /// Features, separated by commas.
    pub features: &'a str,
}

/// Why there is no image.
#[derive(Debug)]
#[non_exhaustive]
pub enum BuildError {
    /// Cargo could not be started.
    Cargo(io::Error),
    /// Cargo failed; its own words went to the standard error stream.
    Failed,
    /// Cargo succeeded but named no executable.
    NoImage,
}

impl Display for BuildError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cargo(error) => write!(f, "cargo could not be started: {error}"),
            Self::Failed => f.write_str(
                "the firmware does not build; is the target installed (rustup target add)?",
            ),
            Self::NoImage => f.write_str("cargo named no firmware image"),
        }
    }
}

impl Error for BuildError {}

/// Builds an image with the profile `chip` of the workspace and returns its path.
///
/// # Errors
///
/// When cargo fails. It runs in this package's directory, so the sources must be where they were compiled.
pub fn build_image(image: &Image<'_>) -> Result<PathBuf, BuildError> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args([
            "build",
            "--quiet",
            "--profile=chip",
            "--message-format=json-render-diagnostics",
        ])
        .args(["--target", image.machine.target(), "--bin", image.bin])
        .args(["--features", image.features])
        .stderr(Stdio::inherit())
        .output()
        .map_err(BuildError::Cargo)?;
    if !output.status.success() {
        return Err(BuildError::Failed);
    }
    executable(&String::from_utf8_lossy(&output.stdout)).ok_or(BuildError::NoImage)
}

/// The one executable among cargo's messages. Paths with quotes or backslashes are not unescaped: such a path
/// is then not found, which is reported.
fn executable(messages: &str) -> Option<PathBuf> {
    let (_, rest) = messages.rsplit_once("\"executable\":\"")?;
    let (path, _) = rest.split_once('"')?;
    Some(PathBuf::from(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn executable_is_found_among_messages() {
        let messages = concat!(
            "{\"reason\":\"compiler-artifact\",\"executable\":null,\"fresh\":true}\n",
            "{\"reason\":\"compiler-artifact\",\"executable\":\"/t/pil\",\"fresh\":true}\n",
            "{\"reason\":\"build-finished\",\"success\":true}\n",
        );
        assert_eq!(executable(messages), Some(PathBuf::from("/t/pil")));
        assert_eq!(executable("{\"executable\":null}"), None);
    }
}
