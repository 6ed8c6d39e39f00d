//! Telemetry from the robot to a host.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use controller_core::safety::supervisor::{Cause, State};

use super::{BaseTick, FieldParams, RecordedPose, RecordedRows, Recording};

/// Who answers; the first thing to read after connecting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Protocol version, again, so that a log of payloads alone is readable.
    pub protocol: u8,
    /// Firmware version: major, minor, patch.
    pub firmware: [u8; 3],
    /// From one control tick to the next, µs: of few periods a whole number goes into a second.
    pub period_us: u32,
}

impl Hello {
    /// That of this firmware.
    pub const OURS: Self = Self {
        protocol: super::VERSION,
        firmware: [0, 1, 0],
        period_us: 1000,
    };
}

/// What went wrong so far, and how deep the stack got.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Accepted frames.
    pub frames_good: u32,
    /// Rejected frames.
    pub frames_rejected: u32,
    /// Reports and answers that found their queue full.
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
    /// The queue of references, or that of commands, is full.
    Full,
    /// The flash did not take it.
    Storage,
    /// This firmware does not do that.
    Unsupported,
}

impl Display for RejectReason {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::State => "not in this state",
            Self::Value => "a value is out of its range",
            Self::Full => "the queue is full",
            Self::Storage => "the flash did not take it",
            Self::Unsupported => "this firmware does not do that",
        })
    }
}

impl Error for RejectReason {}

/// Why nothing stored is in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotLoaded {
    /// There is no memory for it.
    NoMemory,
    /// Nothing was ever stored.
    Empty,
    /// No slot is whole.
    Damaged,
    /// What is whole is of another version.
    Version(u8),
    /// The flash cannot be read.
    Unreadable,
    /// Whole, and out of this firmware's ranges.
    Refused,
    /// The host asked for the defaults.
    Asked,
}

/// Where the parameters in use come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Origin {
    /// Compiled in, for this reason.
    Defaults(NotLoaded),
    /// From the flash.
    Stored {
        /// The number of the record; each one saved has the next.
        sequence: u32,
    },
    /// From the host, not stored.
    Host,
}

/// A message from the robot.
// See `Command`: moved once, never boxed.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Telemetry {
    /// Answer to a heartbeat.
    Hello(Hello),
    /// One tick of a base.
    Tick(BaseTick),
    /// Where the parameters come from: after power-on and whenever that changes.
    Origin(Origin),
    /// Answer to the request for parameters.
    Parameters(FieldParams),
    /// The supervisor changed its state, or a command was refused for it: then before the refusal. Once a second while the base
    /// sends no ticks.
    State {
        /// Ticks since power-on; wraps around.
        tick: u32,
        /// Its state.
        state: State,
        /// Why.
        cause: Cause,
    },
    /// Answer to the request for counters.
    Counters(Counters),
    /// The command with the frame's sequence number was taken.
    Ack,
    /// The command with the frame's sequence number was refused.
    Nack(RejectReason),
    /// A bench recording began or ended.
    Recording(Recording),
    /// Ticks of a bench recording.
    Rows(RecordedRows),
    /// An external pose in a bench recording.
    RecordedPose(RecordedPose),
}
