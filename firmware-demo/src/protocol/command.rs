//! What a host tells the robot.

use serde::{Deserialize, Serialize};

use super::values::real;
use super::{ParameterSet, TimedSample, WireDemand, WireMeasured, WirePose, WireReference};

/// A message to the robot.
// The receiver keeps one of these by value and moves it once; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// "I am alive": keeps the watchdog of the link quiet; answered with a hello.
    Heartbeat,
    /// Make the wheels ready to move.
    Arm,
    /// A reference to append to the queue. One per frame: a batch would make every command as large in memory
    /// as the longest batch, and moving that costs more than the nine bytes that a batch saves.
    Sample(TimedSample),
    /// Drive to a pose and stay there.
    Park {
        /// Where to.
        goal: WirePose,
    },
    /// Make the wheels safe.
    Stop,
    /// Leave the fault state.
    ResetFault,
    /// Replace the parameters, within validation. A running controller keeps those that it was started with.
    SetParameters(ParameterSet),
    /// Start a controller (processor in the loop only); answered with its report.
    Begin {
        /// Where the reference is.
        reference: WireReference,
        /// Where the robot is.
        measured: WireMeasured,
    },
    /// One tick of the controller (processor in the loop only); answered with its report.
    Tick {
        /// s since the tick before.
        #[serde(deserialize_with = "real")]
        dt: f32,
        /// What to do.
        demand: WireDemand,
        /// Where the robot is.
        measured: WireMeasured,
    },
    /// Send the counters.
    GetCounters,
}
