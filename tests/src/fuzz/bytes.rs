//! Values out of bytes, until there are none.

/// What is left of an input.
#[derive(Clone, Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

/// Floats at which something may change.
const FLOATS: [f32; 16] = [
    0.0,
    -0.0,
    1.0e-45,
    1.0e-38,
    1.0e-3,
    0.1,
    -0.4,
    1.0,
    -3.0,
    100.0,
    1.0e4,
    -1.0e30,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

impl Bytes<'_> {
    /// The next byte; `None` at the end.
    pub fn take(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// The next byte, or 0.
    pub fn byte(&mut self) -> u8 {
        self.take().unwrap_or(0)
    }

    /// The next four bytes as a number.
    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// Mostly a sensible float up to `scale`, sometimes a special one, sometimes any.
    pub fn float(&mut self, scale: f32) -> f32 {
        match self.byte() {
            kind @ 0..=15 => FLOATS[usize::from(kind)],
            16..=31 => f32::from_bits(self.word()),
            _ => scale * f32::from(self.byte() as i8) / 127.0,
        }
    }

    /// One of several.
    pub fn one_of<T: Copy, const N: usize>(&mut self, all: [T; N]) -> T {
        all[usize::from(self.byte()) % N]
    }
}
