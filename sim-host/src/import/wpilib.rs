//! WPILib trajectory JSON: an array of `{time, velocity, acceleration, curvature, pose}`.

use super::Format;
use super::json::{Elements, Lenient, document, samples};
use super::raw::{Raw, RawSample};
use super::refusal::Refusal;
use super::repair::{Fix, Repairs};
use serde::Deserialize;

/// Beyond this the base turns on the spot, and velocity times curvature is rounding \[1/m\].
const MAX_CURVATURE: f64 = 1e4;
/// Turn rates above this come from a curvature that means nothing \[rad/s\].
const MAX_TURN_RATE: f64 = 50.0;

#[derive(Deserialize)]
struct State {
    time: f64,
    #[serde(default)]
    velocity: Lenient,
    #[serde(default)]
    acceleration: Lenient,
    pose: Pose,
    #[serde(default)]
    curvature: Lenient,
}

#[derive(Deserialize)]
struct Pose {
    translation: Translation,
    rotation: Rotation,
}

#[derive(Deserialize)]
struct Translation {
    x: f64,
    y: f64,
}

#[derive(Deserialize)]
struct Rotation {
    radians: f64,
}

/// Reads the array. Acceleration is only looked at: the reference has its own.
pub(super) fn read(text: &str) -> Result<Raw, Refusal> {
    let elements: Elements<'_> = document(Format::WpilibJson, text)?;
    let states = samples::<State>(Format::WpilibJson, text, &elements)?;
    let mut repairs = Repairs::default();
    let mut list = Vec::with_capacity(states.len());
    for (place, state) in states {
        for (field, value) in [
            ("velocity", state.velocity),
            ("acceleration", state.acceleration),
            ("curvature", state.curvature),
        ] {
            if value.0.is_none() {
                repairs.add(place.clone().field(field), state.time, Fix::ValueIgnored);
            }
        }
        let mut w = None;
        if let (Some(v), Some(k)) = (state.velocity.0, state.curvature.0) {
            if k.abs() <= MAX_CURVATURE && (v * k).abs() <= MAX_TURN_RATE {
                w = Some(v * k);
            } else {
                let place = place.clone().field("curvature");
                repairs.add(place, state.time, Fix::CurvatureIgnored(k));
            }
        }
        list.push(RawSample {
            place,
            t: state.time,
            x: state.pose.translation.x,
            y: state.pose.translation.y,
            theta: state.pose.rotation.radians,
            v: state.velocity.0,
            w,
        });
    }
    Ok(Raw {
        format: Format::WpilibJson,
        samples: list,
        repairs,
    })
}
