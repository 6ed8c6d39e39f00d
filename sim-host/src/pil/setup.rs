//! What has to be installed, said so that it can be.

use crate::closed_loop::ClosedLoopError;
use crate::run::RunError;
use controller_core::error::ParamError;
use firmware_demo::host::{BuildError, ChipError, EmulatorError, Machine};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Why a chip did not fly a scenario.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PilError {
    /// The firmware has no such law.
    #[error(
        "{0}: the firmware has the neural law with the paper's parking only; \
         run this file with `sim-host run`"
    )]
    Law(String),
    /// No emulator.
    #[error("{program} is not installed: apt-get install -y --no-install-recommends {package}")]
    MissingEmulator {
        /// The program.
        program: &'static str,
        /// Its package on Debian and Ubuntu.
        package: &'static str,
    },
    /// No compiler for the chip.
    #[error("Rust cannot compile for the chip yet: rustup target add {0}")]
    MissingTarget(&'static str),
    /// Anything else of chip, emulator and link.
    #[error(transparent)]
    Chip(#[from] ChipError),
    /// Parameters that are out of range once they are in single precision.
    #[error("{name}: {cause}")]
    Params {
        /// The scenario.
        name: String,
        /// Which and why.
        cause: ParamError,
    },
    /// A mission ended early.
    #[error("{name}: {cause}")]
    Base {
        /// The mission.
        name: String,
        /// Why.
        cause: ClosedLoopError,
    },
    /// The run ended early.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The image cannot be read.
    #[error("{}: {cause}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// The firmware ended otherwise than it should.
    #[error("the firmware ended with exit code {code:?}\n{console}")]
    Ended {
        /// None after a signal.
        code: Option<i32>,
        /// What it printed.
        console: String,
    },
}

/// Sees through an error to what is missing on this machine.
pub(super) fn explain(machine: Machine, error: ChipError) -> PilError {
    match &error {
        ChipError::Emulator(EmulatorError::Start(program, cause))
            if cause.kind() == ErrorKind::NotFound =>
        {
            PilError::MissingEmulator {
                program,
                package: package(machine),
            }
        }
        ChipError::Build(BuildError::Failed) if !has_target(machine.target()) => {
            PilError::MissingTarget(machine.target())
        }
        _ => PilError::Chip(error),
    }
}

fn package(machine: Machine) -> &'static str {
    match machine {
        Machine::CortexM4F => "qemu-system-arm",
        Machine::Riscv32 => "qemu-system-misc",
    }
}

/// The compiler has a standard library for the target. Unknown counts as yes.
fn has_target(target: &str) -> bool {
    let output = Command::new("rustc")
        // Here the pinned tool chain is in force.
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["--print", "target-libdir", "--target", target])
        .output();
    match output {
        Ok(output) if output.status.success() => {
            let path = String::from_utf8_lossy(&output.stdout);
            Path::new(path.trim()).exists()
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_emulators_are_named_with_their_package() {
        for (machine, package) in [
            (Machine::CortexM4F, "qemu-system-arm"),
            (Machine::Riscv32, "qemu-system-misc"),
        ] {
            let cause = ErrorKind::NotFound.into();
            let error = EmulatorError::Start(machine.emulator(), cause);
            let shown = explain(machine, ChipError::Emulator(error)).to_string();
            assert!(
                shown.contains(package) && shown.contains("apt-get install"),
                "{shown}"
            );
        }
    }

    #[test]
    fn a_target_that_nobody_has_is_missed() {
        // Known to the compiler, not installed here or in any script of the workspace.
        assert!(!has_target("thumbv4t-none-eabi"));
    }
}
