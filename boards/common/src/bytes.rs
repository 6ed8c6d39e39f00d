//! Bytes from the receive interrupt to the background.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// One slot for every value of the indices, which so wrap around by themselves and never miss the array.
const SLOTS: usize = 256;

/// A ring in a `static`: one side pushes, one side pops, neither waits.
pub struct Bytes {
    slots: [AtomicU8; SLOTS],
    head: AtomicU8,
    tail: AtomicU8,
    lost: AtomicU32,
}

impl Bytes {
    /// An empty ring.
    pub const fn new() -> Self {
        Self {
            slots: [const { AtomicU8::new(0) }; SLOTS],
            head: AtomicU8::new(0),
            tail: AtomicU8::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Adds a byte; one that finds no room is lost and counted, and the frame it belonged to is refused by its check
    /// sum.
    pub fn push(&self, byte: u8) {
        let tail = self.tail.load(Ordering::Relaxed);
        let next = tail.wrapping_add(1);
        if next == self.head.load(Ordering::Acquire) {
            let lost = self.lost.load(Ordering::Relaxed);
            self.lost.store(lost.wrapping_add(1), Ordering::Relaxed);
        } else {
            self.slots[usize::from(tail)].store(byte, Ordering::Relaxed);
            self.tail.store(next, Ordering::Release);
        }
    }

    /// Takes the oldest byte.
    pub fn pop(&self) -> Option<u8> {
        let head = self.head.load(Ordering::Relaxed);
        if head == self.tail.load(Ordering::Acquire) {
            return None;
        }
        let byte = self.slots[usize::from(head)].load(Ordering::Relaxed);
        self.head.store(head.wrapping_add(1), Ordering::Release);
        Some(byte)
    }

    /// Bytes that found no room.
    pub fn lost(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }
}

impl Default for Bytes {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_in_first_out_around_the_ring_and_full_at_255() {
        let bytes = Bytes::new();
        for round in 0..1000_u32 {
            bytes.push(round as u8);
            assert_eq!(bytes.pop(), Some(round as u8));
        }
        for byte in 0..=255 {
            bytes.push(byte);
        }
        assert_eq!(bytes.lost(), 1);
        assert!((0..255).all(|byte| bytes.pop() == Some(byte)));
        assert_eq!(bytes.pop(), None);
    }
}
