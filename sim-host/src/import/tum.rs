//! TUM poses: `t x y z qx qy qz qw` a line, `#` comments; z up, x of the body ahead.

use super::raw::{Raw, RawSample};
use super::refusal::{NotPlanar, Place, Reason, Refusal};
use super::repair::Repairs;
use super::{Format, MAX_SAMPLES, says_nothing};

/// Leaning \[rad\] and height \[m\] that a wheeled base does not reach on a floor.
const MAX_TILT: f64 = 0.1;
const MAX_HEIGHT: f64 = 0.1;
/// Rounding of a quaternion's norm.
const NORM: f64 = 0.02;
const NAMES: [&str; 8] = ["t", "x", "y", "z", "qx", "qy", "qz", "qw"];

/// Reads the lines; heading is the yaw of the quaternion.
pub(super) fn read(text: &str) -> Result<Raw, Refusal> {
    let mut samples: Vec<RawSample> = Vec::new();
    let mut ground = None;
    for (index, line) in text.lines().enumerate() {
        if says_nothing(line) {
            continue;
        }
        let place = Place::sample(index + 1, samples.len());
        let refuse = |place, reason| Refusal::new(Format::TumPoses, place, reason);
        if samples.len() == MAX_SAMPLES {
            return Err(refuse(place, Reason::TooManySamples { limit: MAX_SAMPLES }));
        }
        let [t, x, y, z, qx, qy, qz, qw] = numbers(line, &place)?;
        let norm = (qx * qx + qy * qy + qz * qz + qw * qw).sqrt();
        if norm.is_nan() || (norm - 1.0).abs() > NORM {
            return Err(refuse(place, Reason::NotARotation(norm)));
        }
        // The body's vertical in the world; its z component is the cosine of the tilt.
        let up = 1.0 - 2.0 * (qx * qx + qy * qy) / (norm * norm);
        let tilt = libm::acos(up.clamp(-1.0, 1.0));
        if tilt > MAX_TILT {
            return Err(refuse(place, Reason::NotPlanar(NotPlanar::Tilt(tilt))));
        }
        let height = z - *ground.get_or_insert(z);
        if height.is_nan() || height.abs() > MAX_HEIGHT {
            let place = place.field("z");
            return Err(refuse(place, Reason::NotPlanar(NotPlanar::Height(height))));
        }
        samples.push(RawSample {
            place,
            t,
            x,
            y,
            theta: libm::atan2(
                2.0 * (qw * qz + qx * qy),
                qw * qw + qx * qx - qy * qy - qz * qz,
            ),
            v: None,
            w: None,
        });
    }
    Ok(Raw {
        format: Format::TumPoses,
        samples,
        repairs: Repairs::default(),
    })
}

/// Eight finite numbers.
fn numbers(line: &str, place: &Place) -> Result<[f64; 8], Refusal> {
    let mut values = [0.0; 8];
    let found = line.split_whitespace().count();
    if found != values.len() {
        let reason = Reason::WrongCount {
            found,
            expected: values.len(),
        };
        return Err(Refusal::new(Format::TumPoses, place.clone(), reason));
    }
    for ((value, text), name) in values.iter_mut().zip(line.split_whitespace()).zip(NAMES) {
        *value = text
            .parse::<f64>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| {
                let text = text.chars().take(40).collect();
                let place = place.clone().field(name);
                Refusal::new(Format::TumPoses, place, Reason::NotANumber(text))
            })?;
    }
    Ok(values)
}
