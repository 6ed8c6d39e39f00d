//! Sectors 1 and 2 of the flash, which `memory.x` keeps free of the program: where parameters are stored.
//!
//! Register by register (RM0383, 3.5): the HAL's flash can panic, when it unlocks and when it reads.

use core::ptr::{addr_of, read_volatile, write_volatile};

use board_common::Slots;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use stm32f4xx_hal::pac::FLASH;

/// Bytes of one of them.
const SECTOR: u32 = 16 * 1024;
/// Two of them.
const LENGTH: u32 = 2 * SECTOR;
/// The first one's number.
const FIRST: u8 = 1;
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

#[allow(unsafe_code)]
unsafe extern "C" {
    /// Their first byte, by `memory.x`.
    static _parameters: u8;
}

/// Both sectors, as one flash of two erase units.
pub struct Sectors {
    flash: FLASH,
    /// An erase holds the core for up to half a second, so none begins once the base ticks.
    may_erase: bool,
}

impl Sectors {
    /// A memory for half a sector of records at least (32), until power comes on again. What fails here fails again, and is
    /// reported, when something is to be stored.
    pub fn prepared(flash: FLASH) -> Slots<Self> {
        let mut slots = Slots::new(Self {
            flash,
            may_erase: true,
        });
        let _ = slots.prepare();
        slots.flash_mut().may_erase = false;
        slots
    }

    /// Where a part of the sectors is.
    fn place(offset: u32, len: usize) -> Result<usize, NorFlashErrorKind> {
        let end = u32::try_from(len)
            .ok()
            .and_then(|len| offset.checked_add(len));
        if end.is_none_or(|end| end > LENGTH) {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        // A name of the linker: only its address means something.
        let begin = addr_of!(_parameters) as usize;
        Ok(begin.wrapping_add(offset as usize))
    }

    /// Unlocks the registers for `work`, and says how it ended.
    fn unlocked(&mut self, work: impl FnOnce(&FLASH)) -> Result<(), NorFlashErrorKind> {
        let flash = &self.flash;
        for key in KEYS {
            #[allow(unsafe_code)]
            // SAFETY: the keys of the manual, in their order.
            flash.keyr().write(|w| unsafe { w.key().bits(key) });
        }
        // Errors of before are cleared by writing ones.
        flash.sr().write(|w| {
            w.pgserr().clear_bit_by_one();
            w.pgperr().clear_bit_by_one();
            w.pgaerr().clear_bit_by_one();
            w.wrperr().clear_bit_by_one();
            w.operr().clear_bit_by_one()
        });
        work(flash);
        wait(flash);
        let now = flash.sr().read();
        let failed = now.pgserr().bit()
            || now.pgperr().bit()
            || now.pgaerr().bit()
            || now.wrperr().bit()
            || now.operr().bit();
        flash.cr().write(|w| w.lock().set_bit());
        // The data cache may hold what was there before.
        let cached = flash.acr().read().dcen().bit();
        flash.acr().modify(|_, w| w.dcen().clear_bit());
        flash.acr().modify(|_, w| w.dcrst().set_bit());
        flash.acr().modify(|_, w| w.dcrst().clear_bit());
        flash.acr().modify(|_, w| w.dcen().bit(cached));
        if failed {
            Err(NorFlashErrorKind::Other)
        } else {
            Ok(())
        }
    }
}

fn wait(flash: &FLASH) {
    while flash.sr().read().bsy().bit() {}
}

impl ErrorType for Sectors {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let from = Self::place(offset, bytes.len())?;
        for (at, byte) in (from..).zip(bytes) {
            #[allow(unsafe_code)]
            // SAFETY: inside of the two sectors, which are memory like any other when nothing is written.
            {
                *byte = unsafe { read_volatile(at as *const u8) };
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        LENGTH as usize
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        if !self.may_erase {
            return Err(NorFlashErrorKind::Other);
        }
        let second = match (from, to) {
            (0, SECTOR) => 0,
            (SECTOR, LENGTH) => 1,
            _ => return Err(NorFlashErrorKind::NotAligned),
        };
        self.unlocked(|flash| {
            flash.cr().write(|w| {
                w.psize().psize32();
                #[allow(unsafe_code)]
                // SAFETY: a sector of this chip.
                unsafe {
                    w.snb().bits(FIRST + second);
                }
                w.ser().set_bit()
            });
            flash.cr().modify(|_, w| w.strt().set_bit());
        })
    }

    /// 64 words of a record take 1 ms, 6 ms at worst; the supply has to be above 2.7 V.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let to = Self::place(offset, bytes.len())?;
        let (words, rest) = bytes.as_chunks::<4>();
        if !offset.is_multiple_of(4) || !rest.is_empty() {
            return Err(NorFlashErrorKind::NotAligned);
        }
        self.unlocked(|flash| {
            flash.cr().write(|w| {
                w.psize().psize32();
                w.pg().set_bit()
            });
            for (at, word) in (to..).step_by(4).zip(words) {
                #[allow(unsafe_code)]
                // SAFETY: inside of the two sectors, where no program is, on a boundary of words.
                unsafe {
                    write_volatile(at as *mut u32, u32::from_le_bytes(*word));
                }
                wait(flash);
            }
        })
    }
}
