//! Parameters on the chip: records in two slots of flash, so that a loss of power during a write leaves the last one as it was. A slot
//! holds as many records as fit, each behind the last; when it is full the other one is erased and takes over.
//!
//! | byte | what |
//! | --- | --- |
//! | 0 | [`RECORD_VERSION`] |
//! | 1 to 4 | sequence number, little endian: the higher one of two good records is in force, across a wrap-around |
//! | 5 to 251 | [`FieldParams`](protocol::FieldParams) in postcard, then zeros |
//! | 252 to 255 | CRC-32/ISO-HDLC of all bytes before it, little endian |
//!
//! Every version keeps length, version byte and check where they are; the rest may change. A slot is one erase unit of the flash
//! ([`embedded_storage::nor_flash::NorFlash`]), its first record is at its begin.

mod ram;
mod record;
mod slots;

pub use protocol::NotLoaded;
pub use ram::RamFlash;
pub use record::{RECORD, RECORD_VERSION, Record, RecordError};
pub use slots::{Loaded, Memory, NoMemory, SaveError, Slots};
