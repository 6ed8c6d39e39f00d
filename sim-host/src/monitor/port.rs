//! The line to the board: a serial port, or the Unix socket of an emulator.

use super::MonitorError;
use protocol::{Command, MAX_FRAME, encode};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, OFlags, flock};
use rustix::termios::{ControlModes, OptionalActions, tcgetattr, tcsetattr};
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// An open line that never blocks longer than its time limit.
#[derive(Debug)]
pub struct Port {
    file: File,
    sequence: u16,
    serial: bool,
}

/// What came of listening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// So many bytes.
    Bytes(usize),
    /// Nothing in time.
    Silence,
    /// The other end is gone.
    End,
}

impl Port {
    /// Opens a serial port (raw, 8 data bits, no parity, no flow control), or a socket.
    ///
    /// # Errors
    /// [`MonitorError::Open`].
    pub fn open(path: &Path, baud: u32) -> Result<Self, MonitorError> {
        let failed = |cause| MonitorError::Open {
            path: path.to_owned(),
            cause,
        };
        let kind = std::fs::metadata(path).map_err(failed)?.file_type();
        let file = if kind.is_socket() {
            socket(path)
        } else {
            serial(path, baud)
        };
        Ok(Self {
            file: file.map_err(failed)?,
            sequence: 0,
            serial: !kind.is_socket(),
        })
    }

    /// A serial port, whose speed counts; else a socket.
    pub const fn is_serial(&self) -> bool {
        self.serial
    }

    /// Waits at most `patience` for bytes.
    ///
    /// # Errors
    /// [`MonitorError::Line`].
    pub fn receive(
        &mut self,
        into: &mut [u8],
        patience: Duration,
    ) -> Result<Received, MonitorError> {
        let timeout = Timespec {
            tv_sec: patience.as_secs().try_into().unwrap_or(i64::MAX),
            tv_nsec: patience.subsec_nanos().into(),
        };
        let mut ready = [PollFd::new(&self.file, PollFlags::IN)];
        match poll(&mut ready, Some(&timeout)) {
            Ok(0) => return Ok(Received::Silence),
            Ok(_) => {}
            Err(rustix::io::Errno::INTR) => return Ok(Received::Silence),
            Err(error) => return Err(MonitorError::Line(error.into())),
        }
        match self.file.read(into) {
            Ok(0) => Ok(Received::End),
            Ok(bytes) => Ok(Received::Bytes(bytes)),
            Err(error) if error.raw_os_error() == Some(HANG_UP) => Ok(Received::End),
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::Interrupted => Ok(Received::Silence),
                ErrorKind::ConnectionReset => Ok(Received::End),
                _ => Err(MonitorError::Line(error)),
            },
        }
    }

    /// Sends a command and does not wait for its answer, which has the number that is given back.
    ///
    /// # Errors
    /// [`MonitorError::Line`].
    pub fn ask(&mut self, command: &Command) -> Result<u16, MonitorError> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        self.send(sequence, command).map(|()| sequence)
    }

    /// The same with a number of one's own, as [`Questions`](super::Questions) have them.
    ///
    /// # Errors
    /// [`MonitorError::Line`].
    pub fn send(&mut self, sequence: u16, command: &Command) -> Result<(), MonitorError> {
        let mut frame = [0; MAX_FRAME];
        let frame = encode(sequence, command, &mut frame)
            .map_err(|error| MonitorError::Line(io::Error::other(error)))?;
        match self.file.write_all(frame) {
            // A board that does not read: the question is lost, the next one may not be.
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            outcome => outcome.map_err(MonitorError::Line),
        }
    }
}

/// What reading from a terminal fails with when its other end was unplugged or closed.
const HANG_UP: i32 = rustix::io::Errno::IO.raw_os_error();

fn socket(path: &Path) -> io::Result<File> {
    let stream = UnixStream::connect(path)?;
    stream.set_nonblocking(true)?;
    Ok(File::from(OwnedFd::from(stream)))
}

fn serial(path: &Path, baud: u32) -> io::Result<File> {
    // Without blocking: opening would otherwise wait for the carrier of a modem.
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(flags.bits() as i32)
        .open(path)?;
    let mut settings = tcgetattr(&file)
        .map_err(|_| io::Error::other("neither a serial port nor a Unix socket"))?;
    // Two would take each other's bytes. Not TIOCEXCL: it does not keep root out, and stays with a pseudo-terminal whose user was killed.
    flock(&file, FlockOperation::NonBlockingLockExclusive).map_err(|error| match error {
        rustix::io::Errno::WOULDBLOCK => {
            io::Error::other("in use by another program: end that one first")
        }
        error => error.into(),
    })?;
    settings.make_raw();
    settings.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD | ControlModes::CS8;
    settings.control_modes -= ControlModes::CRTSCTS | ControlModes::CSTOPB | ControlModes::PARENB;
    settings.set_speed(baud)?;
    tcsetattr(&file, OptionalActions::Now, &settings)?;
    Ok(file)
}
