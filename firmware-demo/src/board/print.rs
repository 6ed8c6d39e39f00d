//! Lines on the emulator's console without `core::fmt`, whose code would outweigh the controller.

use core::ffi::CStr;

use super::semihosting::write0;

const LINE_LEN: usize = 96;

/// A line that is gathered and then printed at once; what does not fit is cut.
#[derive(Debug)]
pub struct Line {
    bytes: [u8; LINE_LEN],
    len: usize,
}

impl Line {
    /// An empty line.
    pub const fn new() -> Self {
        Self {
            bytes: [0; LINE_LEN],
            len: 0,
        }
    }

    /// Appends text.
    #[must_use]
    pub fn text(mut self, text: &str) -> Self {
        for &byte in text.as_bytes() {
            self.push(byte);
        }
        self
    }

    /// Appends a blank and a number.
    #[must_use]
    pub fn number(mut self, number: u32) -> Self {
        self.push(b' ');
        self.digits(number)
    }

    /// Appends a blank and `sum / count` with two decimals; `-` for a count of 0.
    #[must_use]
    pub fn mean(mut self, sum: u32, count: u32) -> Self {
        self.push(b' ');
        let (Some(whole), Some(rest)) = (sum.checked_div(count), sum.checked_rem(count)) else {
            return self.text("-");
        };
        let hundredths = u64::from(rest) * 100 / u64::from(count.max(1));
        let line = self.digits(whole).text(".");
        let line = if hundredths < 10 {
            line.text("0")
        } else {
            line
        };
        line.digits(hundredths as u32)
    }

    /// Prints the line.
    pub fn print(mut self) {
        if let Some(end) = self.bytes.get_mut(self.len) {
            *end = b'\n';
        }
        // The last byte is never written, so a terminating zero is always there.
        if let Ok(text) = CStr::from_bytes_until_nul(&self.bytes) {
            write0(text);
        }
    }

    fn digits(mut self, number: u32) -> Self {
        let mut power = 1_000_000_000;
        let mut rest = number;
        let mut leading = true;
        while power > 0 {
            let digit = rest.checked_div(power).unwrap_or(0);
            rest = rest.wrapping_sub(digit.wrapping_mul(power));
            leading &= digit == 0 && power > 1;
            if !leading {
                self.push(b'0'.wrapping_add(digit as u8));
            }
            power /= 10;
        }
        self
    }

    /// Two bytes stay free: the line feed and the terminating zero.
    fn push(&mut self, byte: u8) {
        if self.len < LINE_LEN - 2
            && let Some(place) = self.bytes.get_mut(self.len)
        {
            *place = byte;
            self.len += 1;
        }
    }
}

impl Default for Line {
    fn default() -> Self {
        Self::new()
    }
}
