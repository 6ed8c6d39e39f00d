//! Host's end of the emulated serial port: a Unix socket that the emulator listens on.

use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

/// The serial line.
#[derive(Debug)]
pub struct UartLink {
    stream: UnixStream,
}

impl UartLink {
    /// Connects as soon as the emulator listens, at most `silence` from now.
    ///
    /// # Errors
    ///
    /// What the system says when the time is over.
    pub fn connect(socket: &Path, silence: Duration) -> io::Result<Self> {
        let until = Instant::now() + silence;
        loop {
            match UnixStream::connect(socket) {
                Ok(stream) => {
                    stream.set_read_timeout(Some(silence))?;
                    stream.set_write_timeout(Some(silence))?;
                    return Ok(Self { stream });
                }
                Err(error) if Instant::now() > until => return Err(error),
                Err(_) => thread::sleep(Duration::from_millis(2)),
            }
        }
    }
}

impl Read for UartLink {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        self.stream.read(buf).map_err(as_timeout)
    }
}

impl Write for UartLink {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.stream.write(buf).map_err(as_timeout)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A socket with a timeout reports it as "would block".
fn as_timeout(error: io::Error) -> io::Error {
    if error.kind() == ErrorKind::WouldBlock {
        ErrorKind::TimedOut.into()
    } else {
        error
    }
}
