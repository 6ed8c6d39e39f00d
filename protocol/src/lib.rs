//! The versioned serial protocol between host and robot.
//!
//! A frame on the wire is `cobs(content) 0x00`, and its content is
//!
//! | field | bytes | |
//! |---|---|---|
//! | version | 1 | [`VERSION`] |
//! | sequence | 2 | little endian; an answer carries the number of its question |
//! | payload | 1 to 247 | one [`Command`] or [`Telemetry`] in postcard; of a processor in the loop, one [`pil::Question`] or [`pil::Answer`] |
//! | check | 4 | CRC-32/ISO-HDLC of all bytes before it, little endian |
//!
//! Content stops at [`MAX_CONTENT`] bytes, because up to there consistent-overhead stuffing adds exactly one
//! byte and works in place. The byte 0 occurs only as delimiter, so a receiver that lost its place is back in
//! step at the next one. Floats travel as their bits: a NaN arrives as the NaN that was sent.

#![no_std]
#![forbid(unsafe_code)]

mod cobs;
mod command;
mod convert;
mod decoder;
mod encoder;
mod field;
pub mod pil;
mod recording;
mod robot_blob;
mod telemetry;
mod tick;
mod values;

pub use command::Command;
pub use decoder::{Decoder, Frame, FrameCounters, FrameError};
pub use encoder::{EncodeError, encode};
pub use field::{FieldParams, WireCalibration, WireGains, WireLimits, WireTimeouts, WireYield};
pub use recording::{
    Excite, ROW_BYTES, ROWS, ROWS_FRAME, RecordedPose, RecordedRow, RecordedRows, Recording,
    RecordingEnd, least_baud,
};
pub use robot_blob::{
    MAX_ROBOT_BLOB, ROBOT_BLOB_VERSION, RobotBlobError, decode_robot, encode_robot,
};
pub use telemetry::{Counters, Hello, NotLoaded, Origin, RejectReason, Telemetry};
pub use tick::{BaseTick, WireAction, WireOutcome, tick_flags};
pub use values::{TimedSample, WirePose, WireReference, WireTwist};

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Version of frame layout and message set; a receiver rejects any other.
pub const VERSION: u8 = 10;
/// Most bytes of content in a frame.
pub const MAX_CONTENT: usize = 254;
/// Most bytes of a frame on the wire: content, one byte of stuffing, the delimiter.
pub const MAX_FRAME: usize = MAX_CONTENT + 2;
/// Version and sequence number.
const HEADER_LEN: usize = 3;
const CHECK_LEN: usize = 4;

/// CRC-32/ISO-HDLC, for frames and for stored records. A `static`, so that the table exists once in flash and is never
/// copied to the stack.
pub static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);
