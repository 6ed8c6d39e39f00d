//! Two slots, the older of which is written.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use embedded_storage::nor_flash::NorFlash;

use super::record::{RECORD, Record, RecordError};
use protocol::{FieldParams, NotLoaded};

/// What a memory holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loaded {
    /// The newest whole record, or why there is none.
    pub record: Result<Record, NotLoaded>,
    /// The other slot is neither empty nor whole: a write was cut off, or bits were lost.
    pub damaged: bool,
}

/// Why parameters are not stored. What was stored before still is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveError {
    /// There is no memory for it.
    NoMemory,
    /// The record is longer than its slot, or slots do not fit the flash.
    Size,
    /// The flash failed.
    Flash,
    /// What was read back is not what was written.
    Verify,
}

impl Display for SaveError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoMemory => "there is no memory for parameters",
            Self::Size => "the record does not fit its slot",
            Self::Flash => "the flash failed",
            Self::Verify => "the flash does not hold what was written",
        })
    }
}

impl Error for SaveError {}

/// What keeps parameters while the power is off.
pub trait Memory {
    /// What is stored.
    fn load(&mut self) -> Loaded;

    /// Stores, and returns the number of the record.
    ///
    /// # Errors
    ///
    /// [`SaveError`].
    fn save(&mut self, params: &FieldParams) -> Result<u32, SaveError>;
}

/// For robots that always begin with what they were compiled with.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMemory;

impl Memory for NoMemory {
    fn load(&mut self) -> Loaded {
        Loaded {
            record: Err(NotLoaded::NoMemory),
            damaged: false,
        }
    }
    fn save(&mut self, _: &FieldParams) -> Result<u32, SaveError> {
        Err(SaveError::NoMemory)
    }
}

/// The first two erase units of a flash, or of a partition of one.
#[derive(Clone, Copy, Debug)]
pub struct Slots<F> {
    flash: F,
}

/// What stands in a slot.
type Slot = Result<Record, NotLoaded>;

impl<F: NorFlash> Slots<F> {
    /// Takes the flash; nothing is touched.
    pub const fn new(flash: F) -> Self {
        Self { flash }
    }

    /// The flash again.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn fits(&self) -> bool {
        F::ERASE_SIZE >= RECORD && self.flash.capacity() / 2 >= F::ERASE_SIZE
    }

    fn begin(second: bool) -> u32 {
        if second { F::ERASE_SIZE as u32 } else { 0 }
    }

    fn read(&mut self, second: bool) -> Slot {
        let mut bytes = [0; RECORD];
        if !self.fits() || self.flash.read(Self::begin(second), &mut bytes).is_err() {
            return Err(NotLoaded::Unreadable);
        }
        Record::from_bytes(&bytes).map_err(|error| match error {
            RecordError::Empty => NotLoaded::Empty,
            RecordError::Version(version) => NotLoaded::Version(version),
            RecordError::Check | RecordError::Content => NotLoaded::Damaged,
        })
    }
}

/// Whether the second slot is in force, of two.
fn second_is_newer(first: &Slot, second: &Slot) -> bool {
    match (first, second) {
        // Across the wrap-around: ahead by less than half of all numbers.
        (Ok(first), Ok(second)) => (second.sequence.wrapping_sub(first.sequence) as i32) > 0,
        (Ok(_), Err(_)) => false,
        (Err(_), Ok(_)) => true,
        // A record of another version is what somebody wants to come back to: it is reported, and written over last.
        (Err(first), Err(_)) => !matches!(first, NotLoaded::Version(_)),
    }
}

impl<F: NorFlash> Memory for Slots<F> {
    fn load(&mut self) -> Loaded {
        let (first, second) = (self.read(false), self.read(true));
        let (newer, other) = if second_is_newer(&first, &second) {
            (second, first)
        } else {
            (first, second)
        };
        let record = match (newer, other) {
            // Of two that say nothing, the one that says more.
            (Err(NotLoaded::Empty), Err(why)) => Err(why),
            (newer, _) => newer,
        };
        Loaded {
            record,
            damaged: other.is_err_and(|why| why == NotLoaded::Damaged),
        }
    }

    fn save(&mut self, params: &FieldParams) -> Result<u32, SaveError> {
        if !self.fits() {
            return Err(SaveError::Size);
        }
        let (first, second) = (self.read(false), self.read(true));
        let into_second = !second_is_newer(&first, &second);
        let newest = if into_second { first } else { second };
        let record = Record {
            sequence: newest.map_or(0, |newest| newest.sequence.wrapping_add(1)),
            params: *params,
        };
        let bytes = record.to_bytes().ok_or(SaveError::Size)?;
        let begin = Self::begin(into_second);
        let end = begin.wrapping_add(F::ERASE_SIZE as u32);
        let flash = &mut self.flash;
        flash.erase(begin, end).map_err(|_| SaveError::Flash)?;
        flash.write(begin, &bytes).map_err(|_| SaveError::Flash)?;
        let mut back = [0; RECORD];
        flash.read(begin, &mut back).map_err(|_| SaveError::Flash)?;
        if back == bytes {
            Ok(record.sequence)
        } else {
            Err(SaveError::Verify)
        }
    }
}
