//! What an image takes of flash and RAM.

use object::{Object, ObjectSection, SectionKind};
use serde::Serialize;

/// Bytes of an image by what they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Footprint {
    /// Code.
    pub text: u64,
    /// Constants, vector table included.
    pub rodata: u64,
    /// Initialised variables: in RAM, their start values in flash.
    pub data: u64,
    /// Variables that start as zero or as anything.
    pub bss: u64,
}

/// What the run-time crates reserve of RAM for stack and heap; the stack is measured instead.
const RESERVED: [&str; 2] = [".stack", ".heap"];

impl Footprint {
    /// Of an ELF file.
    ///
    /// # Errors
    /// Not an ELF file.
    pub fn of(elf: &[u8]) -> object::Result<Self> {
        let file = object::File::parse(elf)?;
        let mut footprint = Self::default();
        for section in file.sections() {
            if RESERVED.contains(&section.name().unwrap_or_default()) {
                continue;
            }
            // Sections that are not loaded, such as debug information, are of no such kind.
            let bytes = match section.kind() {
                SectionKind::Text => &mut footprint.text,
                SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => &mut footprint.rodata,
                SectionKind::Data => &mut footprint.data,
                SectionKind::UninitializedData => &mut footprint.bss,
                _ => continue,
            };
            *bytes += section.size();
        }
        Ok(footprint)
    }

    /// Bytes of flash.
    pub fn flash(&self) -> u64 {
        self.text + self.rodata + self.data
    }

    /// Bytes of RAM without the stack.
    pub fn ram(&self) -> u64 {
        self.data + self.bss
    }
}
