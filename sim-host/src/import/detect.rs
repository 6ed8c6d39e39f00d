//! Which format a text is in, by its content.

use super::format::Format;
use super::refusal::{Place, Reason, Refusal, Untimed};
use super::{says_nothing, wpilib};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

/// The names that distinguish JSON objects.
#[derive(Deserialize)]
struct Names<'a> {
    trajectory: Option<IgnoredAny>,
    #[serde(borrow)]
    samples: Option<&'a RawValue>,
    snapshot: Option<IgnoredAny>,
    waypoints: Option<IgnoredAny>,
    #[serde(rename = "globalConstraints")]
    global_constraints: Option<IgnoredAny>,
    #[serde(rename = "goalEndState")]
    goal_end_state: Option<IgnoredAny>,
}

/// The format of a text.
pub(super) fn detect(text: &str) -> Result<Format, Refusal> {
    let refuse = |reason| Refusal {
        format: None,
        place: Place::default(),
        reason,
    };
    match text.trim_start().as_bytes().first() {
        None => return Err(refuse(Reason::Empty)),
        Some(b'[') => return Ok(Format::WpilibJson),
        Some(b'{') => return object(text),
        Some(_) => {}
    }
    let Some((number, line)) = text
        .lines()
        .enumerate()
        .find(|(_, line)| !says_nothing(line))
    else {
        return Err(refuse(Reason::Empty));
    };
    let lower = line.to_ascii_lowercase();
    if lower.contains("tangent x") {
        return Ok(Format::PathWeaver);
    }
    if line.contains(',') {
        return Ok(Format::Csv);
    }
    let values: Vec<_> = line.split_whitespace().take(9).collect();
    if values.len() >= 2 && values.iter().all(|v| v.parse::<f64>().is_ok()) {
        return Ok(Format::TumPoses);
    }
    Err(Refusal {
        place: Place::line(number + 1),
        ..refuse(Reason::UnknownFormat)
    })
}

/// The format of a JSON object.
fn object(text: &str) -> Result<Format, Refusal> {
    let names: Names<'_> = serde_json::from_str(text).map_err(|e| Refusal {
        format: None,
        place: Place::line(e.line()),
        reason: Reason::Malformed(e.to_string()),
    })?;
    if names.trajectory.is_some() {
        Ok(Format::ChoreoTraj)
    } else if names.global_constraints.is_some() || names.goal_end_state.is_some() {
        Ok(Format::PathPlanner)
    } else if let Some(samples) = names.samples {
        if wpilib::has_samples(samples) {
            return Ok(Format::WpilibJson);
        }
        Err(Refusal::new(
            Format::ChoreoTraj,
            Place::default().field("samples"),
            Reason::ChoreoTooOld,
        ))
    } else if names.snapshot.is_some() {
        Err(Refusal::new(
            Format::ChoreoTraj,
            Place::default().field("trajectory"),
            Reason::Untimed(Untimed::Choreo),
        ))
    } else {
        Err(Refusal {
            format: None,
            place: Place::default().field(if names.waypoints.is_some() {
                "waypoints"
            } else {
                "trajectory"
            }),
            reason: Reason::UnknownFormat,
        })
    }
}
