//! The TOML file, key for key. Meaning and ranges are checked in `check`.

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    #[serde(default)]
    pub description: String,
    pub run: Run,
    #[serde(default)]
    pub controller: Controller,
    #[serde(default)]
    pub gains: Gains,
    #[serde(default)]
    pub robot: Robot,
    #[serde(default)]
    pub plant: Plant,
    #[serde(default)]
    pub start: Start,
    pub reference: MotionKeys,
    pub hand_over: Option<HandOver>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Run {
    pub duration: f64,
    pub period: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Controller {
    #[serde(default)]
    pub kind: super::ControlLaw,
    #[serde(default)]
    pub precision: super::Precision,
    #[serde(default)]
    pub maths: super::MathsBackEnd,
    #[serde(default)]
    pub neurons: super::Update,
    #[serde(default)]
    pub parking: super::ParkingLaw,
    pub max_tick: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Gains {
    pub k1: Option<f64>,
    pub k2: Option<f64>,
    pub k3: Option<f64>,
    pub k4: Option<f64>,
    pub k5: Option<f64>,
    pub kd1: Option<f64>,
    pub kd2: Option<f64>,
    pub kc1: Option<f64>,
    pub kc2: Option<f64>,
    #[serde(rename = "A")]
    pub a: Option<f64>,
    #[serde(rename = "B")]
    pub b: Option<f64>,
    #[serde(rename = "D")]
    pub d: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Robot {
    pub m: Option<f64>,
    #[serde(rename = "I")]
    pub inertia: Option<f64>,
    pub r: Option<f64>,
    pub r_right: Option<f64>,
    pub r_left: Option<f64>,
    pub l: Option<f64>,
    pub max_wheel_torque: Option<f64>,
}

#[derive(Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(super) struct Plant {
    pub mass_factor: Option<f64>,
    pub inertia_factor: Option<f64>,
    pub r_right_factor: Option<f64>,
    pub r_left_factor: Option<f64>,
    pub l_factor: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Start {
    pub x: f64,
    pub y: f64,
    pub theta: f64,
    pub v: f64,
    pub w: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct PoseKeys {
    pub x: f64,
    pub y: f64,
    pub theta: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MotionKeys {
    #[serde(default)]
    pub start: PoseKeys,
    #[serde(deserialize_with = "speed")]
    pub v: Profile,
    #[serde(default, deserialize_with = "turn_rate")]
    pub w: Profile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HandOver {
    pub time: f64,
    pub target_at: Option<f64>,
    pub target: Option<PoseKeys>,
    #[serde(default)]
    pub reset: super::ResetRule,
}

/// A number, or mean, amplitude, angular frequency and phase of a sine.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Profile {
    pub mean: f64,
    pub sine: Option<(f64, f64, f64)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SpeedKeys {
    #[serde(default)]
    v0: f64,
    v1: f64,
    #[serde(rename = "Ov")]
    frequency: f64,
    #[serde(default)]
    pv: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TurnRateKeys {
    #[serde(default)]
    w0: f64,
    w1: f64,
    #[serde(rename = "Ow")]
    frequency: f64,
    #[serde(default)]
    pw: f64,
}

impl From<SpeedKeys> for Profile {
    fn from(keys: SpeedKeys) -> Self {
        Self {
            mean: keys.v0,
            sine: Some((keys.v1, keys.frequency, keys.pv)),
        }
    }
}

impl From<TurnRateKeys> for Profile {
    fn from(keys: TurnRateKeys) -> Self {
        Self {
            mean: keys.w0,
            sine: Some((keys.w1, keys.frequency, keys.pw)),
        }
    }
}

fn speed<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Profile, D::Error> {
    deserializer.deserialize_any(ProfileVisitor {
        keys: "{ v0, v1, Ov, pv }",
        table: std::marker::PhantomData::<SpeedKeys>,
    })
}

fn turn_rate<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Profile, D::Error> {
    deserializer.deserialize_any(ProfileVisitor {
        keys: "{ w0, w1, Ow, pw }",
        table: std::marker::PhantomData::<TurnRateKeys>,
    })
}

/// By hand and not `#[serde(untagged)]`, which would lose both the place and the cause of an error.
struct ProfileVisitor<K> {
    keys: &'static str,
    table: std::marker::PhantomData<K>,
}

impl<'de, K: Deserialize<'de> + Into<Profile>> Visitor<'de> for ProfileVisitor<K> {
    type Value = Profile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number or a table {}", self.keys)
    }

    fn visit_f64<E>(self, mean: f64) -> Result<Profile, E> {
        Ok(Profile { mean, sine: None })
    }

    fn visit_i64<E>(self, mean: i64) -> Result<Profile, E> {
        let mean = mean as f64;
        Ok(Profile { mean, sine: None })
    }

    fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Profile, M::Error> {
        K::deserialize(MapAccessDeserializer::new(map)).map(Into::into)
    }
}
