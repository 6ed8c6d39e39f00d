//! A line between host and base: bytes that come late, damaged, or not at all.

use super::random::Random;
use std::collections::VecDeque;

/// What is wrong with a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LineFault {
    /// Share of the bytes that are changed, lost, or followed by one that nobody sent.
    pub damaged: f64,
    /// On its way for so long \[µs\].
    pub delay_us: u64,
}

/// A frame on its way, with what it stands for.
#[derive(Clone, Debug)]
pub(super) struct Sent<T> {
    pub what: T,
    pub bytes: Vec<u8>,
    /// No byte was touched: it is read for sure.
    pub intact: bool,
}

/// One direction of a line. First in, first out, also when the delay changes.
#[derive(Clone, Debug)]
pub(super) struct Line<T> {
    on_the_way: VecDeque<(u64, Sent<T>)>,
    random: Random,
}

impl<T> Line<T> {
    pub fn new(random: Random) -> Self {
        Self {
            on_the_way: VecDeque::new(),
            random,
        }
    }

    /// Puts a frame on the line at `now_us`, behind a delimiter of its own: damage before it does not reach it.
    pub fn send(&mut self, fault: &LineFault, now_us: u64, what: T, frame: &[u8]) {
        let mut bytes = Vec::with_capacity(frame.len() + 1);
        let mut intact = true;
        for &byte in [0].iter().chain(frame) {
            if fault.damaged > 0.0 && self.random.chance(fault.damaged) {
                intact = false;
                let noise = self.random.word();
                match noise % 3 {
                    0 => bytes.push(byte ^ (1 << (noise >> 8 & 7))),
                    1 => {}
                    _ => bytes.extend([byte, (noise >> 8) as u8]),
                }
            } else {
                bytes.push(byte);
            }
        }
        let last = self.on_the_way.back().map_or(0, |(due, _)| *due);
        let due = last.max(now_us + fault.delay_us);
        let sent = Sent {
            what,
            bytes,
            intact,
        };
        self.on_the_way.push_back((due, sent));
    }

    /// The next frame that has arrived by `now_us`.
    pub fn arrived(&mut self, now_us: u64) -> Option<Sent<T>> {
        match self.on_the_way.front() {
            Some((due, _)) if *due <= now_us => self.on_the_way.pop_front().map(|(_, sent)| sent),
            _ => None,
        }
    }
}
