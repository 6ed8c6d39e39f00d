//! What the emulated tests share.
#![allow(dead_code)] // Each test file uses its part.

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

/// Reproducible numbers (xorshift32).
pub struct Random(pub u32);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// In [low, high).
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 8) as f32 * (1.0 / 16_777_216.0)
    }
}
