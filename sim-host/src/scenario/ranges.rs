//! Ranges of what the core leaves open: poses and motions.

use super::file::{File, MotionKeys, PoseKeys, Profile, Start};
use super::source::{Checked, Source};
use crate::motion::ReferenceMotion;
use controller_core::types::Pose;

/// Largest coordinate \[m, rad\]: beyond, double precision is worse than a nanometre, and somebody took another unit.
pub const FAR: f64 = 1.0e6;
/// Latest time on a reference that a robot may be parked at \[s\]: bounds the work of integrating (6).
const LATEST_S: f64 = 1.0e4;
/// Largest speed, turn rate, angular frequency \[m/s, rad/s\]: bounds the work of integrating (6).
const FAST: f64 = 1.0e3;

/// Key, value, largest magnitude.
pub(super) type Value = (String, f64, f64);

/// Refuses the first value out of its range; TOML can say `nan` and `inf` as well.
pub(super) fn check(keys: &File, place: &Source<'_>) -> Checked<()> {
    let mut values = start(&keys.start);
    values.extend(reference(&keys.reference));
    if let Some(PoseKeys { x, y, theta }) = keys.hand_over.as_ref().and_then(|h| h.target) {
        values.extend(pose("hand_over.target", x, y, theta));
    }
    refuse(&values, place)
}

/// Refuses the first value out of its range.
pub(super) fn refuse(values: &[Value], place: &Source<'_>) -> Checked<()> {
    // Not `abs() > limit`, which lets a NaN pass.
    let outside = |(_, value, limit): &&Value| !(-limit..=*limit).contains(value);
    match values.iter().find(outside) {
        Some((key, _, limit)) => {
            Err(place.error(key, format!("must be a number in -{limit:e} to {limit:e}")))
        }
        None => Ok(()),
    }
}

/// Where the reference is at the time to be parked at.
pub(super) fn target_at(
    at: f64,
    motion: &ReferenceMotion,
    place: &Source<'_>,
) -> Checked<Pose<f64>> {
    if !(0.0..=LATEST_S).contains(&at) {
        let message = format!("must be in 0 to {LATEST_S:e} s");
        return Err(place.error("hand_over.target_at", message));
    }
    Ok(*motion.at(at).pose())
}

/// Where a robot starts.
pub(super) fn start(start: &Start) -> Vec<Value> {
    let mut values = pose("start", start.x, start.y, start.theta);
    values.push(("start.v".to_owned(), start.v, FAST));
    values.push(("start.w".to_owned(), start.w, FAST));
    values
}

/// How a reference moves.
pub(super) fn reference(keys: &MotionKeys) -> Vec<Value> {
    let PoseKeys { x, y, theta } = keys.start;
    let mut values = pose("reference.start", x, y, theta);
    values.extend(profile("v", &keys.v));
    values.extend(profile("w", &keys.w));
    values
}

pub(super) fn pose(table: &str, x: f64, y: f64, theta: f64) -> Vec<Value> {
    let keys = [("x", x), ("y", y), ("theta", theta)];
    let named = keys.map(|(key, value)| (format!("{table}.{key}"), value, FAR));
    named.to_vec()
}

/// `signal` is `v` or `w`.
fn profile(signal: &str, profile: &Profile) -> Vec<Value> {
    let key = |name: &str| format!("reference.{signal}{name}");
    match profile.sine {
        None => vec![(key(""), profile.mean, FAST)],
        Some((amplitude, frequency, phase)) => vec![
            (key(&format!(".{signal}0")), profile.mean, FAST),
            (key(&format!(".{signal}1")), amplitude, FAST),
            (key(&format!(".O{signal}")), frequency, FAST),
            (key(&format!(".p{signal}")), phase, FAR),
        ],
    }
}
