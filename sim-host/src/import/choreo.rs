//! Choreo `.traj` of a differential drive, schema 0 (no `omega`, no `sampleType`) to 3.

use super::Format;
use super::columns::{Columns, Names, contradictions};
use super::json::{Elements, Lenient, document, samples};
use super::raw::{Raw, RawSample};
use super::refusal::{Place, Reason, Refusal, Untimed};
use super::repair::{Fix, Repairs};
use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Deserialize)]
struct File<'a> {
    #[serde(borrow)]
    trajectory: Generated<'a>,
    #[serde(default)]
    config: Option<Config>,
}

#[derive(Deserialize)]
struct Generated<'a> {
    #[serde(rename = "sampleType", default)]
    kind: Option<String>,
    #[serde(borrow)]
    samples: Elements<'a>,
}

/// The robot, where a file carries it.
#[derive(Deserialize)]
struct Config {
    #[serde(rename = "differentialTrackWidth", default)]
    track: Option<Quantity>,
}

/// Choreo writes lengths as `{"exp": "0.6 m", "val": 0.6}`, or plainly in snapshots.
#[derive(Deserialize)]
#[serde(untagged)]
enum Quantity {
    Plain(f64),
    Expression { val: f64 },
}

#[derive(Deserialize)]
struct Row {
    t: f64,
    x: f64,
    y: f64,
    heading: f64,
    #[serde(default)]
    vl: Lenient,
    #[serde(default)]
    vr: Lenient,
    #[serde(default)]
    omega: Lenient,
    #[serde(default)]
    al: Lenient,
    #[serde(default)]
    ar: Lenient,
    #[serde(default)]
    fl: Lenient,
    #[serde(default)]
    fr: Lenient,
    /// Only samples of swerve drives have it.
    #[serde(default)]
    vx: Option<IgnoredAny>,
}

/// Reads the file; speeds and forces are compared with the poses and each other.
pub(super) fn read(text: &str) -> Result<Raw, Refusal> {
    let refuse = |place, reason| Refusal::new(Format::ChoreoTraj, place, reason);
    let file: File<'_> = document(Format::ChoreoTraj, text)?;
    match file.trajectory.kind.as_deref() {
        None | Some("Differential") => {}
        Some("Swerve") => {
            let place = Place::default().field("trajectory.sampleType");
            return Err(refuse(place, Reason::OtherDrive("swerve")));
        }
        Some(_) => {
            let place = Place::default().field("trajectory.sampleType");
            return Err(refuse(place, Reason::OtherDrive("unknown")));
        }
    }
    let rows = samples::<Row>(Format::ChoreoTraj, text, &file.trajectory.samples)?;
    let Some((first, row)) = rows.first() else {
        let place = Place::default().field("trajectory.samples");
        return Err(refuse(place, Reason::Untimed(Untimed::Choreo)));
    };
    if row.vx.is_some() && row.vl.0.is_none() {
        let place = first.clone().field("vx");
        return Err(refuse(place, Reason::OtherDrive("swerve")));
    }
    let track = file.config.and_then(|c| c.track).map(|q| match q {
        Quantity::Plain(track) | Quantity::Expression { val: track } => track,
    });
    let columns = Columns::of(rows.iter().map(|(place, r)| {
        let values = [r.t, r.x, r.y, r.heading];
        let speeds = [r.vl.0, r.vr.0, r.omega.0];
        (place, values, speeds, [r.al.0, r.ar.0, r.fl.0, r.fr.0])
    }));
    let mut repairs = Repairs::default();
    let stated = columns.has_turn_rate();
    let track = track.filter(|t| t.is_finite() && *t > 0.0);
    if !stated {
        let from = if track.is_some() {
            "vl, vr and the track width"
        } else {
            "the headings"
        };
        let what = Fix::ColumnDerived {
            column: "omega",
            from,
        };
        repairs.add(first.clone(), row.t, what);
    }
    let names = Names {
        speeds: "vl, vr",
        omega: "omega",
    };
    let bad = contradictions(&columns, names, &mut repairs);
    let list = rows
        .iter()
        .map(|(place, r)| {
            let speeds = r.vl.0.zip(r.vr.0).filter(|_| !bad.speeds);
            let w = match track {
                _ if stated && !bad.omega => r.omega.0,
                Some(track) => speeds.map(|(l, r)| (r - l) / track),
                None => None,
            };
            RawSample {
                place: place.clone(),
                t: r.t,
                x: r.x,
                y: r.y,
                theta: r.heading,
                v: speeds.map(|(l, r)| 0.5 * (l + r)),
                w: w.filter(|w| w.is_finite()),
            }
        })
        .collect();
    Ok(Raw {
        format: Format::ChoreoTraj,
        samples: list,
        repairs,
    })
}
