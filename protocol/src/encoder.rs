//! One message into one frame, in the caller's memory.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use serde::Serialize;

use super::{CHECK_LEN, CRC, HEADER_LEN, MAX_CONTENT, VERSION, cobs};

/// Why a message was not encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EncodeError {
    /// The caller's memory, or the longest frame, is too short for the message.
    TooLong,
}

impl Display for EncodeError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("the message does not fit the frame")
    }
}

impl Error for EncodeError {}

/// Writes `message` as a frame into `out` and returns the written part, delimiter included.
///
/// [`MAX_FRAME`](super::MAX_FRAME) bytes suffice for every message.
///
/// # Errors
///
/// [`EncodeError::TooLong`] when `out` or the longest frame is too short; `out` then holds rubbish.
pub fn encode<'out, M: Serialize>(
    sequence: u16,
    message: &M,
    out: &'out mut [u8],
) -> Result<&'out [u8], EncodeError> {
    let (code, content) = out.split_first_mut().ok_or(EncodeError::TooLong)?;
    let (header, body) = content
        .split_first_chunk_mut::<HEADER_LEN>()
        .ok_or(EncodeError::TooLong)?;
    let [low, high] = sequence.to_le_bytes();
    *header = [VERSION, low, high];
    let payload_len = postcard::to_slice(message, body)
        .map_err(|_| EncodeError::TooLong)?
        .len();
    let len = stamp(code, content, payload_len).ok_or(EncodeError::TooLong)?;
    out.get(..len).ok_or(EncodeError::TooLong)
}

/// Appends check and delimiter and stuffs; not generic, so that it exists once in flash.
fn stamp(code: &mut u8, content: &mut [u8], payload_len: usize) -> Option<usize> {
    let checked_len = HEADER_LEN.checked_add(payload_len)?;
    let content_len = checked_len
        .checked_add(CHECK_LEN)
        .filter(|&len| len <= MAX_CONTENT)?;
    let (checked, rest) = content.split_at_mut_checked(checked_len)?;
    let (check, rest) = rest.split_first_chunk_mut::<CHECK_LEN>()?;
    *check = CRC.checksum(checked).to_le_bytes();
    *rest.first_mut()? = 0;
    *code = cobs::stuff(content.get_mut(..content_len)?)?;
    content_len.checked_add(2)
}
