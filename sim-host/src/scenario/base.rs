//! Files that describe a base, and the tables of them that a mission may have.

use super::file::PoseKeys;
use super::hardware::{
    ControlKeys, EncoderKeys, GainKeys, GyroKeys, HardwareKeys, SpeedDriverKeys,
};
use super::source::{self, Checked, Source};
use super::{ScenarioError, renamed};
use crate::closed_loop;
use crate::constants::period_us;
use crate::mission::BaseSpec;
use crate::numbers;
use crate::plausible::{self, Quantity};
use crate::world;
use controller_core::base::BaseError;
use controller_core::error::{Field, ParamError};
use controller_core::motion::{Limits, SaturationPolicy};
use controller_core::robot::Robot;
use controller_core::safety::PolicyParams;
use controller_core::safety::supervisor::IdleOutput;
use controller_core::types::Pose;
use controller_core::wheels::WheelGeometry;
use serde::Deserialize;
use std::path::Path;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    description: String,
    robot: RobotKeys,
    limits: LimitKeys,
    motor: Option<world::MotorParams>,
    speed_driver: Option<SpeedDriverKeys>,
    battery: Option<world::BatteryParams>,
    friction: Option<world::FrictionParams>,
    encoder: Option<EncoderKeys>,
    pose_source: Option<world::PoseSourceParams>,
    gyro: Option<GyroKeys>,
    control: Option<ControlKeys>,
    #[serde(default)]
    gains: GainKeys,
    #[serde(default)]
    policy: PolicyParams,
    #[serde(default)]
    stops: StopKeys,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct StopKeys {
    #[serde(default)]
    idle_output: IdleOutput,
}

/// All keys are needed: a robot that is half somebody else's is nobody's.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotKeys {
    m: f64,
    #[serde(rename = "I")]
    inertia: f64,
    r: Option<f64>,
    r_right: Option<f64>,
    r_left: Option<f64>,
    l: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LimitKeys {
    speed: f64,
    turn_rate: f64,
    /// What either of the two above needs by itself, unless it is stated.
    rim_speed: Option<f64>,
    accel: f64,
    brake: f64,
    turn_accel: f64,
    jerk: f64,
    turn_jerk: f64,
    wheel_torque: f64,
    #[serde(default)]
    policy: PolicyKey,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum PolicyKey {
    #[default]
    KeepCurvature,
    TurnFirst,
    DriveFirst,
}

impl BaseSpec {
    /// Reads a file with `[robot]` and `[limits]`.
    ///
    /// # Errors
    /// A file that cannot be read, or [`BaseSpec::parse`]'s.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        source::load(path, Self::parse)
    }

    /// A base from its text; `file` is the name that errors show.
    ///
    /// # Errors
    /// Not TOML, an unknown or missing key, or a value of the wrong type or out of range.
    pub fn parse(file: &str, text: &str) -> Result<Self, ScenarioError> {
        let place = Source::new(file, text);
        let keys = toml::from_str(text);
        let keys: File = keys.map_err(|error| place.misread(source::Kind::Robot, &error))?;
        let stem = Path::new(file).file_stem();
        let stem = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let name = if keys.description.is_empty() {
            stem
        } else {
            keys.description
        };
        let mut base = base(name, Some(&keys.robot), Some(&keys.limits), &place)?;
        let hardware = HardwareKeys {
            motor: keys.motor,
            speed_driver: keys.speed_driver,
            battery: keys.battery,
            friction: keys.friction,
            encoder: keys.encoder,
            pose_source: keys.pose_source,
            gyro: keys.gyro,
            control: keys.control,
        };
        base.hardware = hardware.hardware(&base, &place)?;
        // The others follow from the limits and the hardware's period.
        base.gains = keys.gains.over(base.motion().gains);
        if let Err(error) = base.validate() {
            return Err(place.param_error(gain_key(error.field), &error));
        }
        if let Err(error) = keys.policy.validate() {
            return Err(place.error(&format!("policy.{}", error.kind.name()), error));
        }
        base.policy = keys.policy;
        check_noise(&base, &place)?;
        base.idle_output = keys.stops.idle_output;
        base.notes = renamed::notes(file, text);
        Ok(base)
    }
}

/// Whether poses are precise enough for the whole base, whose floor of the speed in the law grows with their noise.
fn check_noise(base: &BaseSpec, place: &Source<'_>) -> Checked<()> {
    let params = closed_loop::params(base, period_us(base));
    let checked = params
        .map_err(BaseError::Param)
        .and_then(|params| params.validate());
    match checked {
        Err(BaseError::Param(error)) if error.field == Field::SlowSpeed => {
            let message = format!(
                "is too much: the law's floor of the speed, `slow`, that follows from it {}; lengths are in m",
                numbers::problem(&error)
            );
            Err(place.error("pose_source.noise_m", message))
        }
        _ => Ok(()),
    }
}

/// A base of the tables that there are, and of the default base's values for the other.
pub(super) fn base(
    name: String,
    robot: Option<&RobotKeys>,
    limits: Option<&LimitKeys>,
    place: &Source<'_>,
) -> Checked<BaseSpec> {
    let mut base = BaseSpec {
        name,
        ..BaseSpec::default()
    };
    if let Some(keys) = robot {
        base.robot = keys.robot(place)?;
    }
    if let Some(keys) = limits {
        base.limits = keys.limits(base.robot.wheels.track_m);
    }
    let one_radius = robot.is_some_and(|keys| keys.r.is_some());
    let Robot {
        mass_kg,
        inertia_kg_m2,
        wheels,
    } = &base.robot;
    let body = plausible::body(wheels, *mass_kg, Some(*inertia_kg_m2)).map_err(|error| {
        let key = match error.quantity {
            Quantity::Mass => "robot.m",
            Quantity::Inertia => "robot.I",
        };
        place.error(key, error)
    });
    if let Err(error) = base.validate() {
        let key = key_of(&error, one_radius);
        // What follows from numbers of the file, such as gains, is at the end of the way; the body is at its beginning.
        return Err(match body {
            Err(body) if !key.contains('.') => body,
            _ => place.param_error(&key, &error),
        });
    }
    body?;
    Ok(base)
}

impl RobotKeys {
    fn robot(&self, place: &Source<'_>) -> Checked<Robot<f64>> {
        let radius = |side: Option<f64>, key: &str| match (self.r, side) {
            (Some(_), Some(_)) => {
                Err(place.error("robot.r", "is both radii: leave out r_right and r_left"))
            }
            (Some(radius), None) | (None, Some(radius)) => Ok(radius),
            (None, None) => Err(place.error(&format!("robot.{key}"), "is missing; r sets both")),
        };
        Ok(Robot {
            mass_kg: self.m,
            inertia_kg_m2: self.inertia,
            wheels: WheelGeometry {
                radius_right_m: radius(self.r_right, "r_right")?,
                radius_left_m: radius(self.r_left, "r_left")?,
                track_m: self.l,
            },
        })
    }
}

impl LimitKeys {
    fn limits(&self, track_m: f64) -> Limits<f64> {
        Limits {
            speed: self.speed,
            turn_rate: self.turn_rate,
            rim_speed: self
                .rim_speed
                .unwrap_or_else(|| Limits::least_rim_speed(self.speed, self.turn_rate, track_m)),
            accel: self.accel,
            brake: self.brake,
            turn_accel: self.turn_accel,
            jerk: self.jerk,
            turn_jerk: self.turn_jerk,
            wheel_torque_nm: self.wheel_torque,
            policy: match self.policy {
                PolicyKey::KeepCurvature => SaturationPolicy::KeepCurvature,
                PolicyKey::TurnFirst => SaturationPolicy::TurnFirst,
                PolicyKey::DriveFirst => SaturationPolicy::DriveFirst,
            },
        }
    }
}

/// The key that sets a parameter of the core. Gains follow from the limits.
fn key_of(error: &ParamError, one_radius: bool) -> String {
    let name = error.field.name();
    match error.field {
        Field::RadiusRight | Field::RadiusLeft if one_radius => "robot.r".to_owned(),
        Field::Mass
        | Field::Inertia
        | Field::RadiusRight
        | Field::RadiusLeft
        | Field::Track
        | Field::WheelMatrix => format!("robot.{name}"),
        Field::MaxWheelTorque => "limits.wheel_torque".to_owned(),
        _ => match name.strip_prefix("max_") {
            Some(limit) => format!("limits.{limit}"),
            None => "limits".to_owned(),
        },
    }
}

/// The key of a gain of the law.
const fn gain_key(field: Field) -> &'static str {
    match field {
        Field::DecayA => "gains.decay",
        Field::K1 => "gains.longitudinal",
        Field::LongitudinalBound => "gains.longitudinal_bound",
        Field::K3 => "gains.heading",
        Field::K2 => "gains.lateral",
        Field::SlowSpeed => "gains.slow",
        Field::K4 => "gains.approach",
        Field::ApproachBrake => "gains.approach_brake",
        Field::SpeedLoop => "gains.speed_loop",
        Field::TurnLoop => "gains.turn_loop",
        Field::DisturbanceBandwidth => "gains.disturbance",
        Field::DisturbanceShare => "gains.disturbance_share",
        _ => "gains",
    }
}

pub(super) fn pose(keys: PoseKeys) -> Pose<f64> {
    Pose::new(keys.x, keys.y, keys.theta)
}
