//! The volume link: two FIFOs of the host, read and written by semihosting.

use embedded_io::{ErrorType, Read, Write};

use super::LinkError;
use super::semihosting::{File, Mode, open};

/// A pair of FIFOs in the emulator's working directory, named from the chip's point of view.
#[derive(Debug)]
pub struct Fifos {
    from_host: File,
    to_host: File,
}

impl Fifos {
    /// Opens `to-chip` and `from-chip`; each waits for the host to open its other end.
    pub fn open() -> Option<Self> {
        let from_host = open(c"to-chip", Mode::Read)?;
        let to_host = open(c"from-chip", Mode::Write)?;
        Some(Self { from_host, to_host })
    }
}

impl ErrorType for Fifos {
    type Error = LinkError;
}

impl Read for Fifos {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, LinkError> {
        self.from_host.read(buf).ok_or(LinkError)
    }
}

impl Write for Fifos {
    fn write(&mut self, buf: &[u8]) -> Result<usize, LinkError> {
        self.to_host.write(buf).ok_or(LinkError)
    }

    fn flush(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}
