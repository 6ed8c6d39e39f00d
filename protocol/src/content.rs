//! What a frame, a blob and a stored record hold, read with little code.

use postcard::de_flavors::Flavor;
use postcard::{Deserializer, Error, Result};
use serde::Deserialize;

/// What `bytes` begin with, and the bytes behind it: [`postcard::take_from_bytes`] in a third of the code. That one checks the room
/// for each of a robot's numbers in place; here one function does.
///
/// # Errors
/// Of postcard: content that ends early, or that is none.
pub fn take_content<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<(T, &'a [u8])> {
    let mut deserializer = Deserializer::from_flavor(Content(bytes));
    let content = T::deserialize(&mut deserializer)?;
    Ok((content, deserializer.finalize()?))
}

/// Bytes of a number in single precision, which most are.
const WORD: usize = 4;

/// The bytes that are not read yet.
struct Content<'a>(&'a [u8]);

impl<'a> Content<'a> {
    /// Of a length that callers know from its type: none looks at it again.
    #[inline(never)]
    fn word(&mut self) -> Option<&'a [u8; WORD]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(taken)
    }

    #[inline(always)]
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }
}

impl<'a> Flavor<'a> for Content<'a> {
    type Remainder = &'a [u8];
    type Source = &'a [u8];

    #[inline]
    fn pop(&mut self) -> Result<u8> {
        let (first, rest) = self
            .0
            .split_first()
            .ok_or(Error::DeserializeUnexpectedEnd)?;
        self.0 = rest;
        Ok(*first)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.0.len())
    }

    #[inline(always)]
    fn try_take_n(&mut self, count: usize) -> Result<&'a [u8]> {
        let taken = if count == WORD {
            self.word().map(<[u8; WORD]>::as_slice)
        } else {
            self.take(count)
        };
        taken.ok_or(Error::DeserializeUnexpectedEnd)
    }

    fn finalize(self) -> Result<Self::Remainder> {
        Ok(self.0)
    }
}
