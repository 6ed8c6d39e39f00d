//! From the control tick to the slow line: decimated, bounded, and honest about what was lost.

use heapless::spsc::Queue;

use crate::queue::{self, Receiver, Sender};

/// The tick's end of the telemetry queue. It never waits; what finds no room is dropped and counted.
pub struct TelemetryQueue<'queue, T, const N: usize> {
    sender: Sender<'queue, T, N>,
    every: u16,
    until_next: u16,
    dropped: u32,
}

impl<'queue, T, const N: usize> TelemetryQueue<'queue, T, N> {
    /// Splits `queue`; of `every` offers one is kept (0 and 1: all).
    pub fn split(queue: &'queue mut Queue<T, N>, every: u16) -> (Self, Receiver<'queue, T, N>) {
        let (sender, receiver) = queue::split(queue);
        (
            Self {
                sender,
                every,
                until_next: 0,
                dropped: 0,
            },
            receiver,
        )
    }

    /// Offers the value of one tick; `make` runs only in ticks that decimation keeps.
    pub fn offer(&mut self, make: impl FnOnce() -> T) {
        if self.until_next > 0 {
            self.until_next -= 1;
            return;
        }
        self.until_next = self.every.saturating_sub(1);
        self.push(make());
    }

    /// Queues a value past decimation, for what must not be thinned out such as a change of state, and says whether there
    /// was room.
    pub fn push(&mut self, value: T) -> bool {
        let sent = self.sender.send(value);
        if !sent {
            self.dropped = self.dropped.saturating_add(1);
        }
        sent
    }

    /// Values that found no room since the start.
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimation_keeps_the_first_and_every_nth() {
        let mut queue = Queue::<u32, 8>::new();
        let (mut telemetry, mut inbox) = TelemetryQueue::split(&mut queue, 3);
        for tick in 0..9 {
            telemetry.offer(|| tick);
        }
        for expected in [0, 3, 6] {
            assert_eq!(inbox.receive(), Some(expected));
        }
        assert_eq!(inbox.receive(), None);
        assert_eq!(telemetry.dropped(), 0);
    }

    #[test]
    fn every_dropped_value_is_counted() {
        // A queue of N slots holds N - 1 values.
        let mut queue = Queue::<u32, 4>::new();
        let (mut telemetry, mut inbox) = TelemetryQueue::split(&mut queue, 0);
        for tick in 0..10 {
            telemetry.offer(|| tick);
        }
        assert_eq!(telemetry.dropped(), 7);
        assert_eq!(inbox.receive(), Some(0));
        assert!(telemetry.push(10));
        assert_eq!(telemetry.dropped(), 7);
        for expected in [1, 2, 10] {
            assert_eq!(inbox.receive(), Some(expected));
        }
    }
}
