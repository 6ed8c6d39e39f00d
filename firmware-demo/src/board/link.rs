//! Which link the emulator was started with; one image serves both.

use embedded_io::{ErrorType, Read, Write};

use super::semihosting::command_line;
use super::{Fifos, LinkError, Uart};

/// The link to the host.
#[derive(Debug)]
pub enum Link {
    /// The serial port, as on a real board.
    Uart(Uart),
    /// Semihosting on two FIFOs.
    Fifos(Fifos),
}

/// Opens the FIFOs when the command line ends in `fifo`, else the serial port.
pub fn open_link() -> Option<Link> {
    let mut line = [0; 64];
    if command_line(&mut line).trim_ascii_end().ends_with(b"fifo") {
        Fifos::open().map(Link::Fifos)
    } else {
        Some(Link::Uart(Uart::open()))
    }
}

impl ErrorType for Link {
    type Error = LinkError;
}

impl Read for Link {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, LinkError> {
        match self {
            Self::Uart(uart) => uart.read(buf),
            Self::Fifos(fifos) => fifos.read(buf),
        }
    }
}

impl Write for Link {
    fn write(&mut self, buf: &[u8]) -> Result<usize, LinkError> {
        match self {
            Self::Uart(uart) => uart.write(buf),
            Self::Fifos(fifos) => fifos.write(buf),
        }
    }

    fn flush(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}
