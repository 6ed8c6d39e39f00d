//! From keys to velocity orders.

use protocol::{Command, WireTwist};
use std::fmt;

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A step forward.
    Forward,
    /// A step backward.
    Backward,
    /// A step to the left.
    Left,
    /// A step to the right.
    Right,
    /// No speed, no turn rate.
    Halt,
    /// Hold the heading, or no more.
    Heading,
    /// The button.
    EmergencyStop,
    /// Leave the fault state and arm.
    Reset,
    /// No more keys.
    Quit,
}

/// What keys do.
pub const KEYS: &str = "w s a d or arrows: faster, slower, left, right; space: halt; h: hold the heading; \
                    x: emergency stop; r: reset and arm; q: quit\n";

/// Reads keys from bytes, arrows included.
#[derive(Clone, Copy, Debug, Default)]
pub struct KeyReader {
    /// Bytes of an arrow's sequence so far: ESC, then `[` or `O`.
    begun: u8,
}

impl KeyReader {
    /// Takes a byte; a key, if that ends one.
    pub fn push(&mut self, byte: u8) -> Option<Key> {
        let begun = std::mem::take(&mut self.begun);
        match (begun, byte) {
            (_, 0x1b) => {
                self.begun = 1;
                None
            }
            (1, b'[' | b'O') => {
                self.begun = 2;
                None
            }
            (2, b'A') => Some(Key::Forward),
            (2, b'B') => Some(Key::Backward),
            (2, b'C') => Some(Key::Right),
            (2, b'D') => Some(Key::Left),
            (_, b'w' | b'W') => Some(Key::Forward),
            (_, b's' | b'S') => Some(Key::Backward),
            (_, b'a' | b'A') => Some(Key::Left),
            (_, b'd' | b'D') => Some(Key::Right),
            (_, b' ') => Some(Key::Halt),
            (_, b'h' | b'H') => Some(Key::Heading),
            (_, b'x' | b'X') => Some(Key::EmergencyStop),
            (_, b'r' | b'R') => Some(Key::Reset),
            // Ctrl-C and Ctrl-D are keys like any other in a raw terminal.
            (_, b'q' | b'Q' | 3 | 4) => Some(Key::Quit),
            _ => None,
        }
    }
}

/// Steps of a stick from its middle to its end.
const STEPS: i8 = 10;

/// A stick of ten steps each way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stick {
    /// At its ends \[m/s, rad/s\].
    most: WireTwist,
    steps: (i8, i8),
    hold_heading: bool,
}

impl Stick {
    /// In its middle, with these speeds at its ends \[m/s, rad/s\].
    pub const fn new(speed: f32, turn_rate: f32, hold_heading: bool) -> Self {
        Self {
            most: WireTwist {
                v: speed,
                w: turn_rate,
            },
            steps: (0, 0),
            hold_heading,
        }
    }

    /// Moves by a key. Those that are no business of a stick do nothing.
    pub fn take(&mut self, key: Key) {
        let step = |from: i8, by: i8| (from + by).clamp(-STEPS, STEPS);
        let (v, w) = self.steps;
        match key {
            Key::Forward => self.steps.0 = step(v, 1),
            Key::Backward => self.steps.0 = step(v, -1),
            Key::Left => self.steps.1 = step(w, 1),
            Key::Right => self.steps.1 = step(w, -1),
            Key::Halt => self.halt(),
            Key::Heading => self.hold_heading = !self.hold_heading,
            Key::EmergencyStop | Key::Reset | Key::Quit => {}
        }
    }

    /// Back to the middle.
    pub const fn halt(&mut self) {
        self.steps = (0, 0);
    }

    /// What it asks for.
    pub fn twist(&self) -> WireTwist {
        let share = |steps: i8| f32::from(steps) / f32::from(STEPS);
        WireTwist {
            v: share(self.steps.0) * self.most.v,
            w: share(self.steps.1) * self.most.w,
        }
    }

    /// The order for it.
    pub fn order(&self) -> Command {
        Command::Drive {
            twist: self.twist(),
            hold_heading: self.hold_heading,
        }
    }
}

impl fmt::Display for Stick {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let WireTwist { v, w } = self.twist();
        let held = if self.hold_heading { " held" } else { "" };
        write!(f, "{v:+.2} m/s {w:+.2} rad/s{held}")
    }
}
