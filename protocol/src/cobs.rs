//! Consistent-overhead byte stuffing (Cheshire and Baker 1999) without an index that could panic.

use super::MAX_CONTENT;

/// Removes every zero from `content` in place and returns the code byte that goes before it.
///
/// Each zero becomes the distance to the next one, the last the distance to the delimiter. `None` when the
/// content is longer than [`MAX_CONTENT`], where a distance would no longer fit a byte.
pub fn stuff(content: &mut [u8]) -> Option<u8> {
    if content.len() > MAX_CONTENT {
        return None;
    }
    let mut distance = 1_u8;
    for byte in content.iter_mut().rev() {
        if *byte == 0 {
            *byte = distance;
            distance = 1;
        } else {
            // Cannot wrap: at most MAX_CONTENT steps from 1.
            distance = distance.wrapping_add(1);
        }
    }
    Some(distance)
}

/// What one non-zero byte from the wire means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unstuffed {
    /// A code byte that adds nothing to the content.
    Nothing,
    /// One byte of content.
    Byte(u8),
}

/// Streaming inverse of [`stuff`]; it also accepts groups longer than we send.
#[derive(Clone, Copy, Debug)]
pub struct Unstuff {
    remaining: u8,
    zero_due: bool,
}

impl Unstuff {
    /// Expects the first code byte of a frame.
    pub const fn new() -> Self {
        Self {
            remaining: 0,
            zero_due: false,
        }
    }

    /// Takes one byte that is not the delimiter.
    #[inline]
    pub const fn push(&mut self, byte: u8) -> Unstuffed {
        if self.remaining > 0 {
            self.remaining -= 1;
            return Unstuffed::Byte(byte);
        }
        let zero = self.zero_due;
        self.remaining = byte.wrapping_sub(1);
        // A full group of 254 is followed by no zero.
        self.zero_due = byte != u8::MAX;
        if zero {
            Unstuffed::Byte(0)
        } else {
            Unstuffed::Nothing
        }
    }

    /// Whether a delimiter may come now: the last group is complete.
    pub const fn is_complete(self) -> bool {
        self.remaining == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round_trip(content: &[u8]) {
        let mut stuffed = [0; MAX_CONTENT];
        let stuffed = &mut stuffed[..content.len()];
        stuffed.copy_from_slice(content);
        let code = stuff(stuffed).unwrap();
        assert!(code != 0 && stuffed.iter().all(|&byte| byte != 0));

        let mut unstuff = Unstuff::new();
        assert_eq!(unstuff.push(code), Unstuffed::Nothing);
        for (&wire, &sent) in stuffed.iter().zip(content) {
            assert_eq!(unstuff.push(wire), Unstuffed::Byte(sent));
        }
        assert!(unstuff.is_complete());
    }

    #[test]
    fn zeros_anywhere_survive() {
        round_trip(&[]);
        round_trip(&[0]);
        round_trip(&[0, 0, 0]);
        round_trip(&[1, 0, 2, 0]);
        round_trip(&[0; MAX_CONTENT]);
        round_trip(&[7; MAX_CONTENT]);
        let mut one_zero = [9; MAX_CONTENT];
        for at in 0..MAX_CONTENT {
            one_zero[at] = 0;
            round_trip(&one_zero);
            one_zero[at] = 9;
        }
    }

    #[test]
    fn longer_content_is_refused() {
        assert_eq!(stuff(&mut [1; MAX_CONTENT + 1]), None);
    }
}
