//! Stops have a place of their own, one word for each kind: a full queue refuses none, and none waits.
//!
//! Everything on its way to the tick has a number, the command receiver counts. A word holds the number of the last stop of its
//! kind, which is how the tick sees that there is a new one, and which commands the host sent before it.

use core::sync::atomic::{AtomicU32, Ordering};

use protocol::Command;

/// Kinds of stops, the most severe first: that one is obeyed first where no other command stands between two.
const KINDS: [Command; 3] = [
    Command::EmergencyStop { brake: false },
    Command::EmergencyStop { brake: true },
    Command::Stop,
];

/// Its place among [`KINDS`].
const fn kind(command: &Command) -> Option<usize> {
    match command {
        Command::EmergencyStop { brake: false } => Some(0),
        Command::EmergencyStop { brake: true } => Some(1),
        Command::Stop => Some(2),
        _ => None,
    }
}

/// Written by the command receiver, read by the tick.
#[derive(Debug, Default)]
pub(super) struct Stops {
    /// Number of the last one of each of [`KINDS`].
    last: [AtomicU32; KINDS.len()],
}

impl Stops {
    /// Takes a stop; `false` for any other command.
    pub(super) fn take(&self, command: &Command, number: u32) -> bool {
        let Some(place) = kind(command).and_then(|kind| self.last.get(kind)) else {
            return false;
        };
        // Whoever sees the number sees the commands before it in the queue.
        place.store(number, Ordering::Release);
        true
    }
}

/// Number of the last stop of each kind that the tick has seen.
#[derive(Debug, Default)]
pub(super) struct Seen([u32; KINDS.len()]);

impl Seen {
    /// Stops that have come since the last call.
    pub(super) fn news(&mut self, stops: &Stops) -> Pending {
        let mut pending = Pending::default();
        let words = stops.last.iter().zip(&mut self.0);
        for ((last, seen), new) in words.zip(&mut pending.0) {
            let number = last.load(Ordering::Acquire);
            if number != *seen {
                *seen = number;
                *new = Some(number);
            }
        }
        pending
    }
}

/// Number of the stop of each kind that is to be obeyed in this tick.
#[derive(Debug, Default)]
pub(super) struct Pending([Option<u32>; KINDS.len()]);

impl Pending {
    /// The next stop that was sent before the command with this number; without a number, any.
    pub(super) fn next_before(&mut self, number: Option<u32>) -> Option<&'static Command> {
        let mut places = KINDS.iter().zip(&mut self.0);
        places
            .find(|(_, stop)| {
                stop.is_some_and(|stop| number.is_none_or(|number| is_before(stop, number)))
            })
            .map(|(kind, stop)| {
                *stop = None;
                kind
            })
    }
}

/// Whether one number was given before another; they wrap around.
pub(super) const fn is_before(one: u32, other: u32) -> bool {
    one != other && other.wrapping_sub(one) <= u32::MAX / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOP: Command = Command::Stop;
    const BRAKE: Command = Command::EmergencyStop { brake: true };
    const RELEASE: Command = Command::EmergencyStop { brake: false };

    #[test]
    fn kinds_stand_where_they_are_looked_for() {
        let places = KINDS.each_ref().map(kind);
        assert_eq!(places, [Some(0), Some(1), Some(2)]);
    }

    #[test]
    fn each_stop_is_news_once_and_stands_where_it_was_sent() {
        let (stops, mut seen) = (Stops::default(), Seen::default());
        assert_eq!(seen.news(&stops).next_before(None), None);
        assert!(!stops.take(&Command::Arm, 1));
        assert!(stops.take(&STOP, 2) && stops.take(&BRAKE, 4) && stops.take(&RELEASE, 5));
        let mut pending = seen.news(&stops);
        assert_eq!(pending.next_before(Some(1)), None);
        assert_eq!(pending.next_before(Some(3)), Some(&STOP));
        assert_eq!(pending.next_before(Some(3)), None);
        let rest = [(); 3].map(|()| pending.next_before(None));
        assert_eq!(rest, [Some(&RELEASE), Some(&BRAKE), None]);
        assert_eq!(seen.news(&stops).next_before(None), None);
        // Of two of a kind the last one counts.
        assert!(stops.take(&STOP, 6) && stops.take(&STOP, 8));
        let mut pending = seen.news(&stops);
        assert_eq!(pending.next_before(Some(7)), None);
        assert_eq!(pending.next_before(Some(9)), Some(&STOP));
    }

    #[test]
    fn numbers_wrap_around() {
        assert!(is_before(u32::MAX, 0) && !is_before(0, u32::MAX));
        assert!(is_before(1, 2) && !is_before(2, 1) && !is_before(2, 2));
    }
}
