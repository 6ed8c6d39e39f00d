//! All parameters of a base as bytes: what a program that is not written in Rust takes in place of constants.
//!
//! | byte | what |
//! | --- | --- |
//! | 0 to 3 | `BASE` |
//! | 4, 5 | [`ROBOT_BLOB_VERSION`], little endian |
//! | 6, 7 | bytes of content, little endian |
//! | 8 on | [`BaseParams`] in postcard |
//! | last 4 | CRC-32/ISO-HDLC of all bytes before it, little endian |
//!
//! Every version keeps magic, version, length and check where they are; the rest may change.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use controller_core::base::BaseParams;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// How every blob begins.
const MAGIC: [u8; 4] = *b"BASE";
/// Version of the content: whatever changes the fields of [`BaseParams`] raises it.
pub const ROBOT_BLOB_VERSION: u16 = 6;
/// Most bytes of a blob.
pub const MAX_ROBOT_BLOB: usize = 1024;
/// That of frames without its table, which takes a kB of flash: a blob is checked once.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
const HEADER: usize = 8;
const CHECK: usize = 4;

/// Why bytes are no robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotBlobError {
    /// They do not begin as a blob does.
    Magic,
    /// There are more or fewer than the blob says of itself.
    Length,
    /// The check does not match: a bit is wrong.
    Check,
    /// Sound, but of another version.
    Version(u16),
    /// Sound, and no parameters.
    Content,
}

impl Display for RobotBlobError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => f.write_str("not a robot"),
            Self::Length => f.write_str("a robot of another length than it states"),
            Self::Check => f.write_str("a damaged robot"),
            Self::Version(version) => write!(f, "a robot of version {version}"),
            Self::Content => f.write_str("a robot without parameters"),
        }
    }
}

impl Error for RobotBlobError {}

/// The blob of a base's parameters, unchecked, at the begin of `into`; `None` if it does not fit.
pub fn encode_robot<'a>(
    params: &BaseParams<f32>,
    into: &'a mut [u8; MAX_ROBOT_BLOB],
) -> Option<&'a [u8]> {
    let (header, rest) = into.split_first_chunk_mut::<HEADER>()?;
    let length = postcard::to_slice(params, rest).ok()?.len();
    let [a, b, c, d] = MAGIC;
    let [e, f] = ROBOT_BLOB_VERSION.to_le_bytes();
    let [g, h] = u16::try_from(length).ok()?.to_le_bytes();
    *header = [a, b, c, d, e, f, g, h];
    let checked = HEADER.checked_add(length)?;
    let check = CRC.checksum(into.get(..checked)?).to_le_bytes();
    let end = checked.checked_add(CHECK)?;
    into.get_mut(checked..end)?.copy_from_slice(&check);
    into.get(..end)
}

/// The parameters in a blob. They are not validated.
///
/// # Errors
/// [`RobotBlobError`]; the check comes before the version, so that damage is never taken for another version.
pub fn decode_robot(blob: &[u8]) -> Result<BaseParams<f32>, RobotBlobError> {
    let Some((checked, check)) = blob.split_last_chunk::<CHECK>() else {
        return Err(RobotBlobError::Length);
    };
    let Some(([a, b, c, d, e, f, g, h], content)) = checked.split_first_chunk::<HEADER>() else {
        return Err(RobotBlobError::Length);
    };
    if [*a, *b, *c, *d] != MAGIC {
        return Err(RobotBlobError::Magic);
    }
    if usize::from(u16::from_le_bytes([*g, *h])) != content.len() {
        return Err(RobotBlobError::Length);
    }
    if CRC.checksum(checked).to_le_bytes() != *check {
        return Err(RobotBlobError::Check);
    }
    let version = u16::from_le_bytes([*e, *f]);
    if version != ROBOT_BLOB_VERSION {
        return Err(RobotBlobError::Version(version));
    }
    match postcard::take_from_bytes(content) {
        Ok((params, [])) => Ok(params),
        _ => Err(RobotBlobError::Content),
    }
}
