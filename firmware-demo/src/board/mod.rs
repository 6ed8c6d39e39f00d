//! The emulated boards: everything that touches hardware, and the only place with `unsafe` but for the symbol of `panic-proof`.
//!
//! `mps2-an386` (Cortex-M4F) and `virt` (riscv32imafc) offer the same names, so that the binaries do not
//! know where they run. Real boards have crates of their own and use none of this.

mod entry;
mod fifo;
mod link;
mod meter;
pub mod print;
pub mod semihosting;
mod stack;
mod timer;

#[cfg(target_arch = "arm")]
#[path = "mps2_an386.rs"]
mod machine;
#[cfg(target_arch = "riscv32")]
#[path = "virt.rs"]
mod machine;
#[cfg(target_arch = "arm")]
#[path = "mps2_timer.rs"]
mod timer_machine;
#[cfg(target_arch = "riscv32")]
#[path = "virt_timer.rs"]
mod timer_machine;

pub use entry::end_of_panic;
pub use fifo::Fifos;
pub use link::{Link, open_link};
pub use machine::Uart;
pub use meter::{Meter, Spread, thousand_nops};
pub use stack::{high_water_mark, paint};
pub use timer::{interrupt, with_ticks};

/// Exit code of a firmware that panicked.
pub const EXIT_PANIC: u32 = 101;
/// Exit code of a link that failed or closed unasked.
pub const EXIT_LINK: u32 = 3;

/// A link to the host did what it should not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkError;

impl core::fmt::Display for LinkError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the link to the host failed")
    }
}

impl core::error::Error for LinkError {}

impl embedded_io::Error for LinkError {
    fn kind(&self) -> embedded_io::ErrorKind {
        embedded_io::ErrorKind::Other
    }
}
