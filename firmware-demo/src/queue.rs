//! The bounded queue between interrupt and main loop: heapless, with handles that know their length.
//!
//! The handles of heapless forget the length `N`, and with it the proof that their division by it cannot
//! fail. These compare the length first, which gives the proof back and turns the division into a mask. That each of their
//! functions links without a panic by itself is tested (`tests/tests/budgets.rs`); where inlining is switched off altogether
//! check and division come apart, and then an image does not link.

use heapless::spsc::{self, Queue};

/// Splits a queue of `N` slots, which holds `N - 1` values, into its two ends.
pub fn split<T, const N: usize>(queue: &mut Queue<T, N>) -> (Sender<'_, T, N>, Receiver<'_, T, N>) {
    let (producer, consumer) = queue.split();
    (Sender(producer), Receiver(consumer))
}

/// The end that fills the queue.
pub struct Sender<'queue, T, const N: usize>(spsc::Producer<'queue, T>);

impl<T, const N: usize> Sender<'_, T, N> {
    /// Appends a value and says whether there was room.
    // Not inlined, so that there is one call below and it is: outlined, it would not see the proof.
    #[inline(never)]
    pub fn send(&mut self, value: T) -> bool {
        self.0.capacity() == N - 1 && self.0.enqueue(value).is_ok()
    }
}

/// The end that empties the queue.
pub struct Receiver<'queue, T, const N: usize>(spsc::Consumer<'queue, T>);

impl<T, const N: usize> Receiver<'_, T, N> {
    /// Takes the oldest value.
    // See `send`.
    #[inline(never)]
    pub fn receive(&mut self) -> Option<T> {
        if self.0.capacity() == N - 1 {
            self.0.dequeue()
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_in_first_out_until_full() {
        let mut queue = Queue::<u8, 4>::new();
        let (mut sender, mut receiver) = split(&mut queue);
        for round in 0..10 {
            assert!([round, 1, 2].into_iter().all(|value| sender.send(value)));
            assert!(!sender.send(3));
            assert_eq!(
                [(); 4].map(|()| receiver.receive()),
                [Some(round), Some(1), Some(2), None]
            );
        }
    }
}
