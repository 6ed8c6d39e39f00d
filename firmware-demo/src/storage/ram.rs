//! A flash made of memory: for tests, and for emulated robots, which forget it with their power.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

/// Two units of so many bytes, written four bytes at a time as the flash of many chips is.
///
/// It behaves like flash: a write can only clear bits, an erase sets them all. And it loses its power on demand: after so many bytes
/// erased or written every call fails, until [`power_on`](Self::power_on).
#[derive(Clone, Debug)]
pub struct RamFlash<const UNIT: usize = 256> {
    bytes: [[u8; UNIT]; 2],
    /// Bytes until the power fails.
    left: Option<u32>,
    erased: [u32; 2],
}

impl Default for RamFlash {
    fn default() -> Self {
        Self::blank()
    }
}

impl<const UNIT: usize> RamFlash<UNIT> {
    /// As it leaves the factory.
    pub const fn blank() -> Self {
        Self {
            bytes: [[0xFF; UNIT]; 2],
            left: None,
            erased: [0; 2],
        }
    }

    /// The power fails before byte `bytes` from now on is erased or written.
    pub const fn fail_after(&mut self, bytes: u32) {
        self.left = Some(bytes);
    }

    /// The power is back, and stays.
    pub const fn power_on(&mut self) {
        self.left = None;
    }

    /// All bytes, to look at and to damage.
    pub const fn bytes_mut(&mut self) -> &mut [u8] {
        self.bytes.as_flattened_mut()
    }

    /// How often each unit was erased.
    pub const fn erased(&self) -> [u32; 2] {
        self.erased
    }

    fn place(&mut self, from: u32, len: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let from = usize::try_from(from).unwrap_or(usize::MAX);
        let bytes = self.bytes_mut().get_mut(from..);
        bytes
            .and_then(|bytes| bytes.get_mut(..len))
            .ok_or(NorFlashErrorKind::OutOfBounds)
    }

    /// Changes bytes one by one, as long as there is power.
    fn change(
        &mut self,
        from: u32,
        len: usize,
        mut new: impl FnMut(u8) -> u8,
    ) -> Result<(), NorFlashErrorKind> {
        let mut left = self.left;
        for byte in self.place(from, len)? {
            match &mut left {
                Some(0) => break,
                Some(left) => *left -= 1,
                None => {}
            }
            *byte = new(*byte);
        }
        self.left = left;
        if left == Some(0) {
            Err(NorFlashErrorKind::Other)
        } else {
            Ok(())
        }
    }
}

impl<const UNIT: usize> ErrorType for RamFlash<UNIT> {
    type Error = NorFlashErrorKind;
}

impl<const UNIT: usize> ReadNorFlash for RamFlash<UNIT> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let place = self.place(offset, bytes.len())?;
        for (to, from) in bytes.iter_mut().zip(place) {
            *to = *from;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * UNIT
    }
}

impl<const UNIT: usize> NorFlash for RamFlash<UNIT> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = UNIT;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        if !from.is_multiple_of(UNIT as u32) || to != from.wrapping_add(UNIT as u32) {
            return Err(NorFlashErrorKind::NotAligned);
        }
        let [first, second] = &mut self.erased;
        let count = if from == 0 { first } else { second };
        *count = count.saturating_add(1);
        self.change(from, UNIT, |_| 0xFF)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        if !offset.is_multiple_of(4) || !bytes.len().is_multiple_of(4) {
            return Err(NorFlashErrorKind::NotAligned);
        }
        let mut new = bytes.iter();
        self.change(offset, bytes.len(), |old| {
            old & new.next().copied().unwrap_or(0xFF)
        })
    }
}
