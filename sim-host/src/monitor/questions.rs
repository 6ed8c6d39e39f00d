//! Commands that wait for their answers, as a host asks them: one after the other, and again where no answer comes.

use firmware_demo::control_server::UNASKED;
use protocol::{Command, Frame, RejectReason, Telemetry};
use std::collections::VecDeque;

/// Without an answer for so long a command is sent again \[µs\].
const AGAIN_US: u64 = 50_000;

/// Time between the samples of a trajectory on the line \[s\].
pub const SAMPLE_S: f64 = 0.05;
/// How far they are ahead of the base \[s\]: ten of them, of the 63 that it keeps.
pub const AHEAD_S: f64 = 0.5;

/// What is to be asked of a base, in order. `N` is what the asker notes with each command. Time is an argument, and so is the
/// line: who owns this sends what is [`due`](Self::due).
#[derive(Clone, Debug)]
pub struct Questions<N> {
    sequence: u16,
    asked: VecDeque<Asked<N>>,
    /// When the first one was sent, if it is under way.
    sent_us: Option<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Asked<N> {
    command: Command,
    sequence: u16,
    note: N,
}

impl<N> Default for Questions<N> {
    fn default() -> Self {
        Self {
            sequence: 0,
            asked: VecDeque::new(),
            sent_us: None,
        }
    }
}

/// Whether a command stops the base.
pub const fn stops(command: &Command) -> bool {
    matches!(command, Command::Stop | Command::EmergencyStop { .. })
}

impl<N: Copy> Questions<N> {
    /// The next sequence number, also for what needs no answer.
    pub const fn number(&mut self) -> u16 {
        self.sequence = (self.sequence + 1) % UNASKED;
        self.sequence
    }

    /// Asks for something, after what was asked before.
    pub fn ask(&mut self, command: Command, note: N) {
        let sequence = self.number();
        self.asked.push_back(Asked {
            command,
            sequence,
            note,
        });
    }

    /// Nothing of it counts any more.
    pub fn clear(&mut self) {
        self.asked.clear();
        self.sent_us = None;
    }

    /// Everything is answered.
    pub fn is_empty(&self) -> bool {
        self.asked.is_empty()
    }

    /// How many wait.
    pub fn len(&self) -> usize {
        self.asked.len()
    }

    /// The first command that waits, with its number, if it is to be sent now.
    pub fn due(&self, now_us: u64) -> Option<(u16, Command)> {
        let Asked {
            sequence, command, ..
        } = self.asked.front()?;
        let is_due = self.sent_us.is_none_or(|sent| now_us >= sent + AGAIN_US);
        is_due.then_some((*sequence, *command))
    }

    /// What was due is under way.
    pub const fn sent(&mut self, now_us: u64) {
        self.sent_us = Some(now_us);
    }

    /// The command that a frame answers, and what came of it. What found a full queue stays, to be sent again at once.
    pub fn answered(
        &mut self,
        frame: &Frame<Telemetry>,
    ) -> Option<(Command, N, Result<(), RejectReason>)> {
        let Asked {
            command,
            sequence,
            note,
        } = *self.asked.front()?;
        let result = match frame.message {
            Telemetry::Ack => Ok(()),
            Telemetry::Nack(reason) => Err(reason),
            _ => return None,
        };
        if frame.sequence != sequence {
            return None;
        }
        self.sent_us = None;
        if result == Err(RejectReason::Full) && !stops(&command) {
            return None;
        }
        self.asked.pop_front();
        Some((command, note, result))
    }
}
