//! What the emulated tests share.

use std::path::PathBuf;
use std::time::Duration;

use firmware_demo::host::{Image, LinkKind, Machine, Options, build_image};

pub const MACHINES: [Machine; 2] = [Machine::CortexM4F, Machine::Riscv32];
/// Longest silence, and longest wait for an end: only a firmware that hangs gets there. The longest program takes 5 s by
/// itself, and 22 s with three builds beside it on two cores.
pub const LIMIT: Duration = Duration::from_secs(120);

pub fn options(machine: Machine, link: LinkKind, icount: bool) -> Options {
    Options {
        machine,
        link,
        icount,
        core: None,
        silence: LIMIT,
    }
}

/// An image built with the panic proof: that it links is half of each test.
pub fn image(machine: Machine, bin: &str) -> PathBuf {
    build_image(&Image {
        machine,
        bin,
        features: "panic-proof",
    })
    .unwrap()
}
