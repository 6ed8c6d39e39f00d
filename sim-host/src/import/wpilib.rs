//! WPILib trajectory JSON: until 2026 an array of `{time, velocity, acceleration, curvature, pose}`; since 2027
//! `{"samples": [{time, pose, velocity, acceleration, leftVelocity, rightVelocity}]}`, for differential drives.

use super::Format;
use super::columns::{Columns, Names, believe, contradictions};
use super::json::{Elements, Lenient, document, samples};
use super::raw::{Raw, RawSample};
use super::refusal::{Reason, Refusal};
use super::repair::{Fix, Repairs};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

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

/// A file since 2027.
#[derive(Deserialize)]
struct File<'a> {
    #[serde(borrow)]
    samples: Elements<'a>,
}

/// A sample since 2027. `velocity` is in the frame of the field: the wheels' velocities tell the same along the heading.
#[derive(Deserialize)]
struct Sample {
    time: f64,
    pose: Pose,
    #[serde(default)]
    velocity: Velocity,
    #[serde(rename = "leftVelocity", default)]
    left: Lenient,
    #[serde(rename = "rightVelocity", default)]
    right: Lenient,
}

#[derive(Default, Deserialize)]
struct Velocity {
    #[serde(default)]
    omega: Lenient,
}

/// Names of a sample that another format does not have.
#[derive(Deserialize)]
struct SampleNames {
    time: Option<IgnoredAny>,
    pose: Option<IgnoredAny>,
}

/// Whether the samples of an object are those of WPILib since 2027. None at all are: then it is said that there are too few.
pub(super) fn has_samples(samples: &RawValue) -> bool {
    let Ok(Elements(all)) = serde_json::from_str(samples.get()) else {
        return false;
    };
    all.first().is_none_or(|first| {
        serde_json::from_str::<SampleNames>(first.get())
            .is_ok_and(|names| names.time.is_some() && names.pose.is_some())
    })
}

/// Reads a file of either kind.
pub(super) fn read(text: &str) -> Result<Raw, Refusal> {
    if text.trim_start().starts_with('{') {
        read_samples(text)
    } else {
        read_states(text)
    }
}

/// Reads samples; velocities are compared with the poses, acceleration is not read: the reference has its own.
fn read_samples(text: &str) -> Result<Raw, Refusal> {
    let file: File<'_> = document(Format::WpilibJson, text)?;
    let rows = samples::<Sample>(Format::WpilibJson, text, &file.samples)?;
    // Samples of a holonomic drive have no wheels.
    if let Some((place, _)) = rows
        .iter()
        .find(|(_, row)| row.left.0.is_none() && row.right.0.is_none())
    {
        let place = place.clone().field("leftVelocity");
        let reason = Reason::OtherDrive("holonomic");
        return Err(Refusal::new(Format::WpilibJson, place, reason));
    }
    let columns = Columns::of(rows.iter().map(|(place, row)| {
        let pose = &row.pose;
        let at = &pose.translation;
        let values = [row.time, at.x, at.y, pose.rotation.radians];
        let speeds = [row.left.0, row.right.0, row.velocity.omega.0];
        (place, values, speeds, [None; 4])
    }));
    let names = Names {
        speeds: "leftVelocity, rightVelocity",
        omega: "velocity.omega",
    };
    let mut repairs = Repairs::default();
    for (place, row) in &rows {
        for (field, value) in [
            ("leftVelocity", row.left),
            ("rightVelocity", row.right),
            ("velocity.omega", row.velocity.omega),
        ] {
            if value.0.is_none() {
                repairs.add(place.clone().field(field), row.time, Fix::ValueIgnored);
            }
        }
    }
    let bad = contradictions(&columns, names, &mut repairs);
    let list = rows.into_iter().map(|(place, row)| RawSample {
        place,
        t: row.time,
        x: row.pose.translation.x,
        y: row.pose.translation.y,
        theta: row.pose.rotation.radians,
        v: row
            .left
            .0
            .zip(row.right.0)
            .filter(|_| !bad.speeds)
            .map(|(left, right)| 0.5 * (left + right)),
        w: row.velocity.omega.0.filter(|_| !bad.omega),
    });
    Ok(Raw {
        format: Format::WpilibJson,
        samples: list.collect(),
        repairs,
    })
}

/// Reads the array. Acceleration is only looked at: the reference has its own.
fn read_states(text: &str) -> Result<Raw, Refusal> {
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
    let names = Names {
        speeds: "velocity",
        omega: "curvature",
    };
    believe(&mut list, names, &mut repairs);
    Ok(Raw {
        format: Format::WpilibJson,
        samples: list,
        repairs,
    })
}
