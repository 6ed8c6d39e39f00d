//! What a host tells the robot.
//!
//! Every float here is read by [`real`]: postcard's own reader of floats copies slices, and at opt-level `s`
//! the compiler no longer proves that their lengths agree, so a panic would be reachable.

use serde::{Deserialize, Deserializer, Serialize};

/// A pose in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WirePose {
    /// m.
    #[serde(deserialize_with = "real")]
    pub x: f32,
    /// m.
    #[serde(deserialize_with = "real")]
    pub y: f32,
    /// rad, positive counter-clockwise, not wrapped.
    #[serde(deserialize_with = "real")]
    pub theta: f32,
}

/// A body velocity; also its rate, per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireTwist {
    /// m/s.
    #[serde(deserialize_with = "real")]
    pub v: f32,
    /// rad/s.
    #[serde(deserialize_with = "real")]
    pub w: f32,
}

/// One reference with the time it is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimedSample {
    /// s since the start of the trajectory.
    #[serde(deserialize_with = "real")]
    pub t: f32,
    /// Reference pose.
    pub pose: WirePose,
    /// Reference velocity.
    pub twist: WireTwist,
    /// Rate of the reference velocity.
    pub accel: WireTwist,
}

/// Everything a tick measures: the question of the processor in the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// Number of the tick.
    pub tick: u32,
    /// s since the tick before.
    #[serde(deserialize_with = "real")]
    pub dt: f32,
    /// Measured pose.
    pub pose: WirePose,
    /// Measured velocity.
    pub twist: WireTwist,
}

/// Parameters a host may change; the receiver validates them before it uses any.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterSet {
    /// Gain of the forward error.
    #[serde(deserialize_with = "real")]
    pub k1: f32,
    /// Gain of the lateral error.
    #[serde(deserialize_with = "real")]
    pub k2: f32,
    /// Gain of the heading error.
    #[serde(deserialize_with = "real")]
    pub k3: f32,
    /// Forward gain in parking.
    #[serde(deserialize_with = "real")]
    pub k4: f32,
    /// Heading gain in parking.
    #[serde(deserialize_with = "real")]
    pub k5: f32,
    /// Forward gain of the torque, kg/s.
    #[serde(deserialize_with = "real")]
    pub k_d1: f32,
    /// Turn gain of the torque, kg m^2/s.
    #[serde(deserialize_with = "real")]
    pub k_d2: f32,
    /// Forward gain of the filtered rate, kg/s.
    #[serde(deserialize_with = "real")]
    pub k_c1: f32,
    /// Turn gain of the filtered rate, kg m^2/s.
    #[serde(deserialize_with = "real")]
    pub k_c2: f32,
    /// Decay A of the neurons, 1/s.
    #[serde(deserialize_with = "real")]
    pub decay: f32,
    /// Upper bound B of the neurons.
    #[serde(deserialize_with = "real")]
    pub upper: f32,
    /// Lower bound D of the neurons.
    #[serde(deserialize_with = "real")]
    pub lower: f32,
    /// kg.
    #[serde(deserialize_with = "real")]
    pub mass: f32,
    /// kg m^2.
    #[serde(deserialize_with = "real")]
    pub inertia: f32,
    /// m.
    #[serde(deserialize_with = "real")]
    pub wheel_radius: f32,
    /// Half of the track, m.
    #[serde(deserialize_with = "real")]
    pub half_track: f32,
    /// Largest torque of a wheel, N m.
    #[serde(deserialize_with = "real")]
    pub max_torque: f32,
}

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
    /// Replace the parameters, within validation.
    SetParameters(ParameterSet),
    /// Compute one tick from this measurement (processor in the loop only).
    Measure(Measure),
    /// Send the counters.
    GetCounters,
}

/// A float by its four bytes, which is what postcard writes for it.
fn real<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    let (a, b, c, d) = Deserialize::deserialize(deserializer)?;
    Ok(f32::from_le_bytes([a, b, c, d]))
}
