//! The background's half: bytes in, frames out.

use firmware_demo::protocol::{Frame, MAX_FRAME, Telemetry, encode};
use firmware_demo::station::Reception;

use crate::bytes::Bytes;

/// Bits per second of every board, as `sim-host monitor PORT --baud 921600` expects.
pub const BAUD: u32 = 921_600;

/// Commands to the tick, telemetry to the line.
pub struct Line<'queue> {
    reception: Reception<'queue>,
    frame: [u8; MAX_FRAME],
    len: usize,
    sent: usize,
}

impl<'queue> Line<'queue> {
    pub(crate) const fn new(reception: Reception<'queue>) -> Self {
        Self {
            reception,
            frame: [0; MAX_FRAME],
            len: 0,
            sent: 0,
        }
    }

    /// Some work, of bounded length: sends what there is to send, then hears what there is to hear.
    ///
    /// `send` takes a byte if the transmitter has room. Answers come before telemetry, and nothing is heard while an
    /// answer is on its way: `received` holds more than that takes.
    pub fn poll(&mut self, received: &Bytes, mut send: impl FnMut(u8) -> bool) {
        while let Some(&byte) = self.frame.get(self.sent).filter(|_| self.sent < self.len) {
            if !send(byte) {
                return;
            }
            self.sent = self.sent.wrapping_add(1);
        }
        // No more than the ring holds, so that a flood does not keep telemetry from being sent.
        for _ in 0..u8::MAX {
            let Some(byte) = received.pop() else {
                break;
            };
            // The stack is painted and looked at in the emulator only.
            if let Some(answer) = self.reception.push(byte, || 0) {
                return self.load(&answer);
            }
        }
        if let Some(telemetry) = self.reception.pending() {
            self.load(&telemetry);
        }
    }

    fn load(&mut self, Frame { sequence, message }: &Frame<Telemetry>) {
        self.sent = 0;
        self.len = encode(*sequence, message, &mut self.frame).map_or(0, |bytes| bytes.len());
    }
}
