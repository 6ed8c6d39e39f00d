//! The background's half: bytes in, frames out.

use firmware_demo::control_server::CommandReceiver;
use heapless::Deque;
use protocol::{Frame, MAX_FRAME, Telemetry, encode};

use crate::bytes::Bytes;

/// Bits per second of every board, as `sim-host monitor PORT --baud 921600` expects.
pub const BAUD: u32 = 921_600;

/// Answers that wait for the transmitter.
const ANSWERS: usize = 16;

/// Commands to the tick, telemetry to the line.
pub struct Line<'queue> {
    receiver: CommandReceiver<'queue>,
    answers: Deque<Frame<Telemetry>, ANSWERS>,
    frame: [u8; MAX_FRAME],
    len: usize,
    sent: usize,
}

impl<'queue> Line<'queue> {
    pub(crate) const fn new(receiver: CommandReceiver<'queue>) -> Self {
        Self {
            receiver,
            answers: Deque::new(),
            frame: [0; MAX_FRAME],
            len: 0,
            sent: 0,
        }
    }

    /// Some work, of bounded length: hears what there is to hear, then sends what there is to send.
    ///
    /// `send` takes a byte if the transmitter has room. Nothing that is sent keeps the line from being read: a host that
    /// asks for more than the line carries, or does not read, loses answers, which are counted, and delays no stop.
    /// Answers come before telemetry.
    pub fn poll(&mut self, received: &Bytes, mut send: impl FnMut(u8) -> bool) {
        // No more than the ring holds, so that a flood does not keep answers from being sent.
        for _ in 0..u8::MAX {
            let Some(byte) = received.pop() else {
                break;
            };
            // The stack is painted and looked at in the emulator only.
            if let Some(answer) = self.receiver.push(byte, || 0)
                && self.answers.push_back(answer).is_err()
            {
                self.receiver.count_dropped();
            }
        }
        while let Some(&byte) = self.frame.get(self.sent).filter(|_| self.sent < self.len) {
            if !send(byte) {
                return;
            }
            self.sent = self.sent.wrapping_add(1);
        }
        let next = self.answers.pop_front();
        if let Some(next) = next.or_else(|| self.receiver.pending()) {
            self.load(&next);
        }
    }

    fn load(&mut self, Frame { sequence, message }: &Frame<Telemetry>) {
        self.sent = 0;
        self.len = encode(*sequence, message, &mut self.frame).map_or(0, |bytes| bytes.len());
    }
}
