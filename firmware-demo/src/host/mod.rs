//! The host's side: build an image, start the emulator, talk to the firmware.
//!
//! Everything here ends: links have a silence limit, the emulator a life limit, and dropping it kills it.

mod chip;
mod emulator;
mod fifo;
mod image;
mod session;
mod uart;

pub use chip::{BaseChip, BoardChip, Chip, ChipError, ChipLink};
pub use emulator::{Emulator, EmulatorError, EmulatorOutcome, LinkKind, Machine, Options, trace};
pub use fifo::FifoLink;
pub use image::{BuildError, Image, build_image};
pub use session::{Session, SessionError};
pub use uart::UartLink;

use std::boxed::Box;
use std::io::{Read, Write};

/// A byte link to firmware: reading waits, but never longer than its silence limit.
pub trait HostLink: Read + Write + Send {}

impl<L: Read + Write + Send> HostLink for L {}

/// Any link, chosen at run time.
pub type AnyLink = Box<dyn HostLink>;
