//! The whole firmware of a base, its line included, one tick at a time: what a host sends in place of wheels, sensors and the
//! bytes of another host, and what it gets back.

use controller_core::base::Sensed;
use controller_core::types::Pose;
use serde::{Deserialize, Serialize};

use super::{BasePart, WheelOutput};
use crate::RejectReason;

/// Bytes of the line under way in a question or an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LineBytes {
    len: u8,
    bytes: [[u8; 32]; 4],
}

impl LineBytes {
    /// Most of them.
    pub const MOST: usize = 128;

    /// The first of these, as many as there is room for.
    pub fn of(bytes: impl IntoIterator<Item = u8>) -> Self {
        let mut line = Self::default();
        for (free, byte) in line.bytes.as_flattened_mut().iter_mut().zip(bytes) {
            *free = byte;
            line.len += 1;
        }
        line
    }

    /// All of them.
    pub fn as_slice(&self) -> &[u8] {
        let bytes = self.bytes.as_flattened();
        bytes.get(..self.len.into()).unwrap_or(bytes)
    }
}

/// A question to a chip that has the whole firmware. Each has one answer.
// See `Question`: moved once, never boxed.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BoardQuestion {
    /// Parameters of the base.
    Configure(BasePart),
    /// Start the base, disarmed, with the parameters that were sent. Once.
    Begin {
        /// Where it is.
        start: Pose<f32>,
        /// One report of so many ticks goes to the line.
        decimate: u16,
    },
    /// Bytes from the line.
    Receive(LineBytes),
    /// The timer's interrupt; answered with [`BoardAnswer::Ticked`].
    Tick {
        /// The clock \[µs\]; wraps around.
        now_us: u32,
        /// What the base senses, the drivers' answers included.
        sensed: Sensed<f32>,
    },
    /// The bytes for the line that wait; answered with [`BoardAnswer::Sent`].
    Send,
    /// No more questions.
    Stop,
}

/// The answer to a question.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BoardAnswer {
    /// What a tick did.
    Ticked {
        /// What acts on the wheels until the next tick.
        output: WheelOutput,
        /// Bytes that wait for the line.
        waiting: u16,
    },
    /// Bytes for the line.
    Sent(LineBytes),
    /// Done.
    Ack,
    /// Not done.
    Nack(RejectReason),
}
