//! Poses of a bag, as a trajectory file.

use crate::ros::read::{Messages, ReadError};
use std::fmt::Write as _;

/// The poses of a topic as TUM text, which is what recorded poses are; times count from the first one. None: of the only
/// topic that has some.
///
/// # Errors
/// A bag that cannot be read, or has no such poses.
pub fn bag_poses(bytes: &[u8], topic: Option<&str>) -> Result<String, ReadError> {
    let messages = Messages::read(bytes)?;
    if let Some(why) = &messages.cut {
        // Nobody wants to drive half of a way without knowing it.
        let problem = format!("the bag ends early, {why}; `mcap recover` makes a whole one of it");
        return Err(ReadError::Content(problem));
    }
    let poses = messages.poses(topic)?;
    let first = poses.first().map_or(0, |pose| pose.ns);
    let mut text = String::new();
    for pose in &poses {
        // To the nanosecond; a bag may have poses out of order, which is for the importer to say.
        let ns = i128::from(pose.ns) - i128::from(first);
        let [x, y, z] = pose.position;
        let [qx, qy, qz, qw] = pose.orientation;
        let t = 1.0e-9 * ns as f64;
        // Writing to a string does not fail.
        let _ = writeln!(text, "{t} {x} {y} {z} {qx} {qy} {qz} {qw}");
    }
    Ok(text)
}
