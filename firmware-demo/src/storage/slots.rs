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
    /// Where the next record goes, once that is known: reading all of a slot takes longer than a tick.
    next: Option<Next>,
    /// The slot that is not in force is erased.
    spare: bool,
}

/// What stands in a slot: its newest whole record, or why there is none.
type Newest = Result<Record, NotLoaded>;

/// A slot as it was read.
#[derive(Clone, Copy)]
struct Slot {
    newest: Newest,
    /// Places up to the last that is not empty.
    used: u32,
    /// One of them is not whole.
    damaged: bool,
}

/// The place of the next record, and its number.
#[derive(Clone, Copy, Debug)]
struct Next {
    second: bool,
    place: u32,
    /// It has to be erased before.
    erase: bool,
    sequence: u32,
}

impl<F: NorFlash> Slots<F> {
    /// Takes the flash; nothing is touched.
    pub const fn new(flash: F) -> Self {
        Self {
            flash,
            next: None,
            spare: false,
        }
    }

    /// The flash again.
    pub fn into_flash(self) -> F {
        self.flash
    }

    /// The flash, for what else it can do.
    pub const fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Makes room before it is needed, where an erase takes longer than a tick may: once half of the slot in force is used, the
    /// other one is erased, so that as many records again as a slot holds are written without an erase.
    ///
    /// # Errors
    ///
    /// [`SaveError::Size`] and [`SaveError::Flash`]. What is stored still is.
    pub fn prepare(&mut self) -> Result<(), SaveError> {
        if !self.fits() {
            return Err(SaveError::Size);
        }
        let next = self.find();
        if next.erase {
            self.erase(next.second)?;
        } else {
            let used = self.read(!next.second).used > 0;
            if used && next.place > Self::PLACES / 2 {
                self.erase(!next.second)?;
            }
            self.spare = !used || next.place > Self::PLACES / 2;
        }
        self.next = Some(Next {
            erase: false,
            ..next
        });
        Ok(())
    }

    /// Records that a slot holds.
    const PLACES: u32 = (F::ERASE_SIZE / RECORD) as u32;

    fn fits(&self) -> bool {
        F::ERASE_SIZE >= RECORD && self.flash.capacity() / 2 >= F::ERASE_SIZE
    }

    const fn begin(second: bool, place: u32) -> u32 {
        let begin = if second { F::ERASE_SIZE as u32 } else { 0 };
        begin.wrapping_add(place.wrapping_mul(RECORD as u32))
    }

    fn erase(&mut self, second: bool) -> Result<(), SaveError> {
        let begin = Self::begin(second, 0);
        let end = begin.wrapping_add(F::ERASE_SIZE as u32);
        self.flash.erase(begin, end).map_err(|_| SaveError::Flash)
    }

    /// Records are appended, so the last whole one is the newest.
    fn read(&mut self, second: bool) -> Slot {
        let mut slot = Slot {
            newest: Err(NotLoaded::Empty),
            used: 0,
            damaged: false,
        };
        if !self.fits() {
            slot.newest = Err(NotLoaded::Unreadable);
            return slot;
        }
        for place in 0..Self::PLACES {
            let mut bytes = [0; RECORD];
            let read = self.flash.read(Self::begin(second, place), &mut bytes);
            let found = match read.map(|()| Record::from_bytes(&bytes)) {
                Ok(Err(RecordError::Empty)) => continue,
                Ok(Ok(record)) => Ok(record),
                Ok(Err(RecordError::Version(version))) => Err(NotLoaded::Version(version)),
                Ok(Err(RecordError::Check | RecordError::Content)) => Err(NotLoaded::Damaged),
                Err(_) => Err(NotLoaded::Unreadable),
            };
            slot.used = place.wrapping_add(1);
            slot.damaged |= found == Err(NotLoaded::Damaged);
            if found.is_ok() || slot.newest.is_err() {
                slot.newest = found;
            }
        }
        slot
    }

    /// The next record goes behind the newest one, or into the other slot.
    fn find(&mut self) -> Next {
        if let Some(next) = self.next {
            return next;
        }
        let (first, second) = (self.read(false), self.read(true));
        Self::behind(&first, &second)
    }

    fn behind(first: &Slot, second: &Slot) -> Next {
        let in_second = second_is_newer(&first.newest, &second.newest);
        let slot = if in_second { second } else { first };
        let sequence = slot
            .newest
            .map_or(0, |newest| newest.sequence.wrapping_add(1));
        let room = slot.newest.is_ok() && slot.used < Self::PLACES;
        Next {
            second: in_second == room,
            place: if room { slot.used } else { 0 },
            erase: !room,
            sequence,
        }
    }
}

/// Whether the second slot is in force, of two.
fn second_is_newer(first: &Newest, second: &Newest) -> bool {
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
        let (newer, other) = if second_is_newer(&first.newest, &second.newest) {
            (second, first)
        } else {
            (first, second)
        };
        let record = match (newer.newest, other.newest) {
            // Of two that say nothing, the one that says more.
            (Err(NotLoaded::Empty), Err(why)) => Err(why),
            (newer, _) => newer,
        };
        Loaded {
            record,
            damaged: other.newest == Err(NotLoaded::Damaged)
                || newer.newest.is_ok() && newer.damaged,
        }
    }

    fn save(&mut self, params: &FieldParams) -> Result<u32, SaveError> {
        if !self.fits() {
            return Err(SaveError::Size);
        }
        let next = self.find();
        // Whatever fails from here on, the next try looks anew.
        self.next = None;
        let record = Record {
            sequence: next.sequence,
            params: *params,
        };
        let bytes = record.to_bytes().ok_or(SaveError::Size)?;
        if next.erase {
            self.erase(next.second)?;
        }
        let begin = Self::begin(next.second, next.place);
        let flash = &mut self.flash;
        flash.write(begin, &bytes).map_err(|_| SaveError::Flash)?;
        let mut back = [0; RECORD];
        flash.read(begin, &mut back).map_err(|_| SaveError::Flash)?;
        if back != bytes {
            return Err(SaveError::Verify);
        }
        let place = next.place.wrapping_add(1);
        let room = place < Self::PLACES;
        self.next = Some(Next {
            second: next.second == room,
            place: if room { place } else { 0 },
            erase: !room && !self.spare,
            sequence: next.sequence.wrapping_add(1),
        });
        self.spare &= room;
        Ok(record.sequence)
    }
}
