//! Questions and answers over a link.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::io::{self, Read, Write};

use protocol::{Decoder, Frame, FrameCounters, MAX_CONTENT, MAX_FRAME, encode};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why a question has no answer.
#[derive(Debug)]
#[non_exhaustive]
pub enum SessionError {
    /// The link failed, or was silent for too long.
    Link(io::Error),
    /// The firmware's side closed the link.
    Closed,
    /// The command does not fit a frame.
    TooLong,
}

impl Display for SessionError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link(error) => write!(f, "link to the firmware: {error}"),
            Self::Closed => f.write_str("the firmware closed the link"),
            Self::TooLong => f.write_str("the command does not fit a frame"),
        }
    }
}

impl Error for SessionError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Link(error) => Some(error),
            _ => None,
        }
    }
}

impl From<io::Error> for SessionError {
    fn from(error: io::Error) -> Self {
        Self::Link(error)
    }
}

/// The host's state of one link: numbers what goes out and decodes what comes in, messages `A`.
#[derive(Debug)]
pub struct Session<L, A> {
    link: L,
    decoder: Decoder<A, MAX_CONTENT>,
    sequence: u16,
    received: [u8; 512],
    next: usize,
    len: usize,
}

impl<L: Read + Write, A: DeserializeOwned> Session<L, A> {
    /// A session on a fresh link.
    pub const fn new(link: L) -> Self {
        Self {
            link,
            decoder: Decoder::new(),
            sequence: 0,
            received: [0; 512],
            next: 0,
            len: 0,
        }
    }

    /// Sends a command and returns the sequence number it got.
    ///
    /// # Errors
    ///
    /// When the link fails or the command is too long.
    pub fn send(&mut self, command: &impl Serialize) -> Result<u16, SessionError> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let mut frame = [0; MAX_FRAME];
        let frame = encode(sequence, command, &mut frame).map_err(|_| SessionError::TooLong)?;
        self.link.write_all(frame)?;
        Ok(sequence)
    }

    /// Waits for the next sound frame; damaged ones are counted and skipped.
    ///
    /// # Errors
    ///
    /// When the link fails, closes or is silent for too long.
    pub fn receive(&mut self) -> Result<Frame<A>, SessionError> {
        loop {
            while self.next < self.len {
                let byte = self.received[self.next];
                self.next += 1;
                if let Some(Ok(frame)) = self.decoder.push(byte) {
                    return Ok(frame);
                }
            }
            self.next = 0;
            self.len = 0;
            self.len = match self.link.read(&mut self.received)? {
                0 => return Err(SessionError::Closed),
                len => len,
            };
        }
    }

    /// Sends a command and waits for the answer to it, passing over frames with other numbers.
    ///
    /// # Errors
    ///
    /// As [`send`](Self::send) and [`receive`](Self::receive).
    pub fn ask(&mut self, command: &impl Serialize) -> Result<A, SessionError> {
        let sequence = self.send(command)?;
        loop {
            let frame = self.receive()?;
            if frame.sequence == sequence {
                return Ok(frame.message);
            }
        }
    }

    /// What the decoder has seen.
    pub const fn counters(&self) -> FrameCounters {
        self.decoder.counters()
    }
}
