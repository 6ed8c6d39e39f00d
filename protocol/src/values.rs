//! Quantities as they travel.
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

/// What the law needs to know of the reference at one instant; the receiver works out sine and cosine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireReference {
    /// Reference pose.
    pub pose: WirePose,
    /// Reference velocity.
    pub twist: WireTwist,
    /// Rate of the reference velocity.
    pub accel: WireTwist,
    /// What the path has to go until it comes to rest, m, all of it forward or all of it backward; 0 where that is not so or not known.
    #[serde(deserialize_with = "real")]
    pub left: f32,
}

/// One reference with the time it is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimedSample {
    /// s since the start of the trajectory.
    #[serde(deserialize_with = "real")]
    pub t: f32,
    /// The reference at that time.
    pub reference: WireReference,
}

/// A float by its four bytes, which is what postcard writes for it.
pub(super) fn real<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    let (a, b, c, d) = Deserialize::deserialize(deserializer)?;
    Ok(f32::from_le_bytes([a, b, c, d]))
}

/// An optional float, the same way.
pub(super) fn optional_real<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<f32>, D::Error> {
    let bytes: Option<(u8, u8, u8, u8)> = Deserialize::deserialize(deserializer)?;
    Ok(bytes.map(|(a, b, c, d)| f32::from_le_bytes([a, b, c, d])))
}
