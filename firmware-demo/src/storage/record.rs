//! The record: bytes that are whole, or none.

use protocol::{CRC, FieldParams};

/// Bytes of a record: a multiple of every flash's write unit.
pub const RECORD: usize = 256;
/// Version of what is in it.
pub const RECORD_VERSION: u8 = 4;
const HEADER: usize = 5;

/// What a slot holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Its number.
    pub sequence: u32,
    /// What was stored.
    pub params: FieldParams,
}

/// Why bytes are no record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Erased: nothing was ever written.
    Empty,
    /// The check does not match: a bit is wrong, or a write was cut off.
    Check,
    /// Sound, but of another version.
    Version(u8),
    /// Sound, and no parameters.
    Content,
}

impl Record {
    /// The bytes to write; `None` if they were more than a record holds.
    pub fn to_bytes(&self) -> Option<[u8; RECORD]> {
        let mut bytes = [0; RECORD];
        let (checked, check) = bytes.split_last_chunk_mut::<4>()?;
        let (header, content) = checked.split_first_chunk_mut::<HEADER>()?;
        let [a, b, c, d] = self.sequence.to_le_bytes();
        *header = [RECORD_VERSION, a, b, c, d];
        postcard::to_slice(&self.params, content).ok()?;
        *check = CRC.checksum(checked).to_le_bytes();
        Some(bytes)
    }

    /// Reads them again.
    ///
    /// # Errors
    ///
    /// [`RecordError`]; the check comes before the version, so that a damaged record is never taken for a strange one.
    pub fn from_bytes(bytes: &[u8; RECORD]) -> Result<Self, RecordError> {
        if bytes.iter().all(|byte| *byte == 0xFF) {
            return Err(RecordError::Empty);
        }
        let Some((checked, check)) = bytes.split_last_chunk::<4>() else {
            return Err(RecordError::Check);
        };
        if CRC.checksum(checked).to_le_bytes() != *check {
            return Err(RecordError::Check);
        }
        let Some(([version, a, b, c, d], content)) = checked.split_first_chunk::<HEADER>() else {
            return Err(RecordError::Check);
        };
        if *version != RECORD_VERSION {
            return Err(RecordError::Version(*version));
        }
        match postcard::take_from_bytes(content) {
            Ok((params, rest)) if rest.iter().all(|byte| *byte == 0) => Ok(Self {
                sequence: u32::from_le_bytes([*a, *b, *c, *d]),
                params,
            }),
            _ => Err(RecordError::Content),
        }
    }
}
