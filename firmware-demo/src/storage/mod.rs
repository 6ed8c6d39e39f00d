//! Parameters on the chip: one record in two slots of flash, written in turn, so that a loss of power during a write leaves the other
//! one as it was.
//!
//! | byte | what |
//! | --- | --- |
//! | 0 | [`RECORD_VERSION`] |
//! | 1 to 4 | sequence number, little endian: the higher one of two good records is in force, across a wrap-around |
//! | 5 to 251 | [`FieldParams`](crate::protocol::FieldParams) in postcard, then zeros |
//! | 252 to 255 | CRC-32/ISO-HDLC of all bytes before it, little endian |
//!
//! Every version keeps length, version byte and check where they are; the rest may change. A slot is one erase unit of the flash
//! ([`embedded_storage::nor_flash::NorFlash`]), the record is at its begin.

mod ram;
mod record;
mod slots;

pub use crate::protocol::NotLoaded;
pub use ram::RamFlash;
pub use record::{RECORD, RECORD_VERSION, Record, RecordError};
pub use slots::{Loaded, Memory, NoMemory, SaveError, Slots};
