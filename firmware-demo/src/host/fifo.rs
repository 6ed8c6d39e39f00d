//! Host's end of the two FIFOs.

use std::format;
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{CWD, FileType, Mode, OFlags, mknodat};

/// Turns of polling before the thread sleeps: an answer of the emulator is usually a few microseconds away,
/// waking from sleep takes longer.
const SPINS: u32 = 2000;

/// Two FIFOs, both opened without blocking, so that nothing waits for an emulator that never came.
#[derive(Debug)]
pub struct FifoLink {
    to_chip: File,
    from_chip: File,
    silence: Duration,
    opened: bool,
}

impl FifoLink {
    /// Makes `to-chip` and `from-chip` in `directory` and opens the host's ends.
    ///
    /// # Errors
    ///
    /// What the system says.
    pub fn create(directory: &Path, silence: Duration) -> io::Result<Self> {
        let make = |name: &str| -> io::Result<_> {
            let path = directory.join(name);
            mknodat(CWD, &path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)
                .map_err(|error| io::Error::other(format!("{name}: {error}")))?;
            Ok(path)
        };
        let to_chip = make("to-chip")?;
        let from_chip = make("from-chip")?;
        let nonblocking = OFlags::NONBLOCK.bits() as i32;
        Ok(Self {
            // Read and write: opening only for writing would wait for, or without blocking fail for want of, a
            // reader.
            to_chip: OpenOptions::new()
                .read(true)
                .write(true)
                .custom_flags(nonblocking)
                .open(to_chip)?,
            from_chip: OpenOptions::new()
                .read(true)
                .custom_flags(nonblocking)
                .open(from_chip)?,
            silence,
            opened: false,
        })
    }

    /// Sleeps until `flags` hold or `until` has passed.
    fn wait(file: &File, flags: PollFlags, until: Instant) -> io::Result<()> {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        let timeout = Timespec {
            tv_sec: left.as_secs() as i64,
            tv_nsec: left.subsec_nanos().into(),
        };
        poll(&mut [PollFd::new(file, flags)], Some(&timeout))?;
        Ok(())
    }
}

impl Read for FifoLink {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let mut spins = 0;
        let mut until = None;
        loop {
            match self.from_chip.read(buf) {
                // No writer: not yet there, or gone after it was there.
                Ok(0) if !self.opened => thread::sleep(Duration::from_micros(200)),
                Ok(len) => {
                    self.opened = true;
                    return Ok(len);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    self.opened = true;
                    spins += 1;
                    if spins < SPINS {
                        thread::yield_now();
                        continue;
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
            let until = *until.get_or_insert_with(|| Instant::now() + self.silence);
            if self.opened {
                Self::wait(&self.from_chip, PollFlags::IN, until)?;
            } else if Instant::now() > until {
                return Err(ErrorKind::TimedOut.into());
            }
        }
    }
}

impl Write for FifoLink {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let mut until = None;
        loop {
            match self.to_chip.write(buf) {
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    let until = *until.get_or_insert_with(|| Instant::now() + self.silence);
                    Self::wait(&self.to_chip, PollFlags::OUT, until)?;
                }
                outcome => return outcome,
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
