//! Commands from a host to the robot.

use serde::{Deserialize, Serialize};

use super::values::real;
use super::{Excite, FieldParams, TimedSample, WirePose, WireTwist};

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
    /// Come to rest within the limits and stay there, released. Never refused, and obeyed before commands that came earlier.
    Stop,
    /// The button: latched until a reset. Never refused, as a stop.
    EmergencyStop {
        /// Brake the wheels; if not, release them.
        brake: bool,
    },
    /// Leave the fault state.
    ResetFault,
    /// Put the base elsewhere on the map.
    SetPose {
        /// Where it is.
        pose: WirePose,
    },
    /// An external pose, for a base that takes them.
    Fix {
        /// Where it was.
        pose: WirePose,
        /// How long ago, s.
        #[serde(deserialize_with = "real")]
        age_s: f32,
    },
    /// Replace what may be changed in the field, within validation and while disarmed.
    SetParameters(FieldParams),
    /// Store the parameters in use, for the next power-on; while disarmed.
    SaveParameters,
    /// Back to the parameters that the firmware was compiled with; while disarmed. What is stored stays.
    LoadDefaults,
    /// Send the parameters in use.
    GetParameters,
    /// Send the counters.
    GetCounters,
    /// Drive with a speed and a turn rate until the next one, which is due within the timeout `command`: then the base stops as
    /// its policy says. A base that parks or is parked takes it as well; it has to be armed.
    Drive {
        /// Ordered; beyond the limits of the base it drives at its limits.
        twist: WireTwist,
        /// Keep the heading that the turn rates lead to.
        hold_heading: bool,
    },
    /// Drive for a bench recording, by itself and within a stated space, and send every tick as a row; from Armed. A heartbeat is
    /// due all the while, as an order is in other drives: other frames, of a camera perhaps, are no sign of who watches. Unsupported where
    /// the drivers close their own speed loop: a row has torques or duties, of which nothing is known there.
    Excite(Excite),
}
