//! What the robot tells a host.

use serde::{Deserialize, Serialize};

use super::Report;
use crate::supervisor::State;

/// Who answers; the first thing to read after connecting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Protocol version, again, so that a log of payloads alone is readable.
    pub protocol: u8,
    /// Firmware version: major, minor, patch.
    pub firmware: [u8; 3],
    /// Control ticks per second.
    pub tick_hz: u16,
}

/// What went wrong so far, and how deep the stack got.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Accepted frames.
    pub frames_good: u32,
    /// Rejected frames.
    pub frames_rejected: u32,
    /// Reports that found the telemetry queue full.
    pub reports_dropped: u32,
    /// Ticks that started late.
    pub overruns: u32,
    /// High-water mark of the stack in bytes, 0 where it is not painted.
    pub stack_bytes: u32,
}

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum RejectReason {
    /// Not in this state of the supervisor.
    State,
    /// A value is out of its range or not finite.
    Value,
    /// The reference queue is full.
    Full,
    /// This firmware does not do that.
    Unsupported,
}

/// A message from the robot.
// See `Command`: moved once, never boxed.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Telemetry {
    /// Answer to a heartbeat.
    Hello(Hello),
    /// One tick.
    Report(Report),
    /// The supervisor changed its state.
    State {
        /// Its new state.
        state: State,
        /// Code of the fault that led here, 0 for none.
        fault: u8,
    },
    /// Answer to the request for counters.
    Counters(Counters),
    /// The command with the frame's sequence number was taken.
    Ack,
    /// The command with the frame's sequence number was refused.
    Nack(RejectReason),
}
