//! Bytes from a line into frames, whatever the bytes are.

use core::error::Error;
use core::fmt::{self, Display, Formatter};
use core::marker::PhantomData;

use serde::de::DeserializeOwned;

use super::cobs::{Unstuff, Unstuffed};
use super::{CHECK_LEN, CRC, HEADER_LEN, VERSION};

/// A frame that passed every check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<M> {
    /// The sender's sequence number.
    pub sequence: u16,
    /// What was sent.
    pub message: M,
}

/// Why the bytes before a delimiter were rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrameError {
    /// The delimiter came inside a stuffing group: bytes were lost.
    Framing,
    /// Shorter than header and check, or longer than the buffer.
    Length,
    /// The check does not match the bytes.
    Crc,
    /// A frame of another protocol version.
    Version,
    /// The frame is sound but is no message of this version, or has bytes to spare.
    Payload,
}

impl Display for FrameError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Framing => "delimiter inside a stuffing group",
            Self::Length => "frame too short or too long",
            Self::Crc => "check does not match",
            Self::Version => "another protocol version",
            Self::Payload => "not a message of this version",
        })
    }
}

impl Error for FrameError {}

/// What a decoder has seen, by outcome; the counters stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameCounters {
    /// Accepted frames.
    pub good: u32,
    /// Rejected with [`FrameError::Framing`].
    pub framing: u32,
    /// Rejected with [`FrameError::Length`].
    pub length: u32,
    /// Rejected with [`FrameError::Crc`].
    pub crc: u32,
    /// Rejected with [`FrameError::Version`].
    pub version: u32,
    /// Rejected with [`FrameError::Payload`].
    pub payload: u32,
}

impl FrameCounters {
    /// Rejected frames of every kind.
    pub const fn rejected(&self) -> u32 {
        self.framing
            .saturating_add(self.length)
            .saturating_add(self.crc)
            .saturating_add(self.version)
            .saturating_add(self.payload)
    }

    const fn count(&mut self, error: FrameError) {
        let counter = match error {
            FrameError::Framing => &mut self.framing,
            FrameError::Length => &mut self.length,
            FrameError::Crc => &mut self.crc,
            FrameError::Version => &mut self.version,
            FrameError::Payload => &mut self.payload,
        };
        *counter = counter.saturating_add(1);
    }
}

/// Streaming receiver of frames with messages `M` and at most `N` bytes of content.
///
/// It starts as if a delimiter had just passed. After rubbish it is in step again at the next delimiter, so
/// at most the frame that the rubbish ran into is lost.
#[derive(Clone, Debug)]
pub struct Decoder<M, const N: usize> {
    content: [u8; N],
    len: usize,
    unstuff: Unstuff,
    started: bool,
    overflow: bool,
    counters: FrameCounters,
    message: PhantomData<fn() -> M>,
}

impl<M: DeserializeOwned, const N: usize> Decoder<M, N> {
    /// A decoder that has seen nothing.
    pub const fn new() -> Self {
        Self {
            content: [0; N],
            len: 0,
            unstuff: Unstuff::new(),
            started: false,
            overflow: false,
            counters: FrameCounters {
                good: 0,
                framing: 0,
                length: 0,
                crc: 0,
                version: 0,
                payload: 0,
            },
            message: PhantomData,
        }
    }

    /// Takes one byte; a delimiter that ends a frame gives its message or the reason of its rejection.
    ///
    /// Delimiters in a row are idle filling and give nothing.
    // Inlined, so that a caller's loop keeps the state of a byte in registers; the rare end of a frame is not.
    #[inline]
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<M>, FrameError>> {
        if byte == 0 {
            return self.end();
        }
        self.started = true;
        if let Unstuffed::Byte(content) = self.unstuff.push(byte) {
            if let Some(place) = self.content.get_mut(self.len) {
                *place = content;
                // Cannot wrap: the place exists, so `len < N`.
                self.len = self.len.wrapping_add(1);
            } else {
                self.overflow = true;
            }
        }
        None
    }

    /// What was seen so far.
    pub const fn counters(&self) -> FrameCounters {
        self.counters
    }

    #[inline(never)]
    fn end(&mut self) -> Option<Result<Frame<M>, FrameError>> {
        if !self.started {
            return None;
        }
        let outcome = self.finish();
        match outcome {
            Ok(_) => self.counters.good = self.counters.good.saturating_add(1),
            Err(error) => self.counters.count(error),
        }
        self.len = 0;
        self.unstuff = Unstuff::new();
        self.started = false;
        self.overflow = false;
        Some(outcome)
    }

    fn finish(&self) -> Result<Frame<M>, FrameError> {
        if self.overflow {
            return Err(FrameError::Length);
        }
        if !self.unstuff.is_complete() {
            return Err(FrameError::Framing);
        }
        let content = self.content.get(..self.len).ok_or(FrameError::Length)?;
        let (sequence, payload) = open(content)?;
        match postcard::take_from_bytes(payload) {
            Ok((message, [])) => Ok(Frame { sequence, message }),
            _ => Err(FrameError::Payload),
        }
    }
}

impl<M: DeserializeOwned, const N: usize> Default for Decoder<M, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Checks the envelope and returns sequence number and payload; not generic, so that it exists once.
fn open(content: &[u8]) -> Result<(u16, &[u8]), FrameError> {
    let (checked, check) = content
        .split_last_chunk::<CHECK_LEN>()
        .ok_or(FrameError::Length)?;
    let (&[version, low, high], payload) = checked
        .split_first_chunk::<HEADER_LEN>()
        .ok_or(FrameError::Length)?;
    if CRC.checksum(checked).to_le_bytes() != *check {
        return Err(FrameError::Crc);
    }
    // After the check: a damaged version byte is a damaged frame, not another version.
    if version != VERSION {
        return Err(FrameError::Version);
    }
    Ok((u16::from_le_bytes([low, high]), payload))
}
