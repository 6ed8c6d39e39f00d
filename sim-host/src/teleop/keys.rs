//! Where keys come from.

use std::io::{self, BufRead};

/// What a source of keys has at the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A key, or a part of one.
    Byte(u8),
    /// Nothing for now: time goes on.
    Nothing,
    /// Nothing any more.
    End,
}

/// A source of keys that never waits.
pub trait KeySource {
    /// The next byte, if there is one.
    ///
    /// # Errors
    /// It cannot be read.
    fn next(&mut self) -> io::Result<Input>;
}

/// Orders that pass with a dot of a script: 0.2 s.
const DOT: u8 = 5;

/// Keys from a pipe or a file, as quickly as they come; `.` lets 0.2 s pass.
#[derive(Debug)]
pub struct Script<R> {
    bytes: io::Bytes<R>,
    waits: u8,
}

impl<R: BufRead> Script<R> {
    /// Of a reader.
    pub fn new(reader: R) -> Self {
        Self {
            bytes: reader.bytes(),
            waits: 0,
        }
    }
}

impl<R: BufRead> KeySource for Script<R> {
    fn next(&mut self) -> io::Result<Input> {
        if self.waits > 0 {
            self.waits -= 1;
            return Ok(Input::Nothing);
        }
        match self.bytes.next().transpose()? {
            None => Ok(Input::End),
            Some(b'.') => {
                self.waits = DOT - 1;
                Ok(Input::Nothing)
            }
            Some(byte) => Ok(Input::Byte(byte)),
        }
    }
}
