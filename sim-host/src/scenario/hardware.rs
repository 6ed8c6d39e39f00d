//! Keys of a base file beside its body and its limits.

use super::ScenarioError;
use super::source::{Checked, Source};
use crate::mission::{BaseSpec, Drivers, Gyro, Hardware, OLDEST_POSE, breakaway_nm};
use crate::numbers::{outside, param};
use crate::world::{
    BatteryParams, FrictionParams, GyroParams, MotorParams, PoseSourceParams, WorldError,
};
use controller_core::base::REMEMBERED;
use controller_core::error::Field;
use controller_core::localiser::LEAST_APART_S;
use controller_core::motion::MotionGains;
use controller_core::motor::{Driver, SpeedParams};
use serde::Deserialize;

/// Tables of the hardware: all of those without a default, or none of them. `[motor]` or `[speed_driver]` makes them needed.
pub(super) struct HardwareKeys {
    pub motor: Option<MotorParams>,
    pub speed_driver: Option<SpeedDriverKeys>,
    pub battery: Option<BatteryParams>,
    pub friction: Option<FrictionParams>,
    pub encoder: Option<EncoderKeys>,
    pub pose_source: Option<PoseSourceParams>,
    pub gyro: Option<GyroKeys>,
    pub control: Option<ControlKeys>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EncoderKeys {
    counts_per_turn: f64,
    /// 50 rad/s: shows accelerations that no torque explains 40 ms late.
    #[serde(default = "speed_bandwidth")]
    bandwidth: f64,
}

fn speed_bandwidth() -> f64 {
    50.0
}

/// Drivers that close their own speed loop.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpeedDriverKeys {
    /// That of the motors without load, where they are known.
    max_speed_rad_s: Option<f64>,
    #[serde(default)]
    min_speed_rad_s: f64,
    lag_s: f64,
}

impl SpeedDriverKeys {
    fn params(
        &self,
        motor: Option<&MotorParams>,
        friction: &FrictionParams,
        nominal_v: f64,
    ) -> Option<SpeedParams<f64>> {
        let free = |motor: &MotorParams| nominal_v / (motor.gear_ratio * motor.kt_nm_per_a);
        Some(SpeedParams {
            max_speed_rad_s: self.max_speed_rad_s.or(motor.map(free))?,
            min_speed_rad_s: self.min_speed_rad_s,
            lag_s: self.lag_s,
            breakaway_nm: breakaway_nm(friction),
        })
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ControlKeys {
    period_s: f64,
}

/// All but the last two are the sensor's, from its data sheet.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GyroKeys {
    noise_density: f64,
    bias_limit: f64,
    #[serde(default)]
    bias_walk: f64,
    scale_error: f64,
    range: f64,
    #[serde(default)]
    resolution: f64,
    rate_hz: f64,
    #[serde(default)]
    latency_s: f64,
    rest_s: Option<f64>,
    carry_s: Option<f64>,
}

impl GyroKeys {
    fn gyro(&self) -> Gyro {
        let usual = controller_core::gyro::GyroParams::<f64>::icm_42688_p();
        Gyro {
            sensor: GyroParams {
                rate_hz: self.rate_hz,
                latency_s: self.latency_s,
                noise_density: self.noise_density,
                bias_limit: self.bias_limit,
                bias_walk: self.bias_walk,
                scale_error: self.scale_error,
                range: self.range,
                resolution: self.resolution,
            },
            rest_s: self.rest_s.unwrap_or(usual.rest_s),
            carry_s: self.carry_s.unwrap_or(usual.carry_s),
        }
    }
}

/// Gains that are not to follow from the limits.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GainKeys {
    decay: Option<f64>,
    #[serde(alias = "along")]
    longitudinal: Option<f64>,
    #[serde(alias = "along_bound")]
    longitudinal_bound: Option<f64>,
    heading: Option<f64>,
    #[serde(alias = "across")]
    lateral: Option<f64>,
    slow: Option<f64>,
    approach: Option<f64>,
    approach_brake: Option<f64>,
    speed_loop: Option<f64>,
    turn_loop: Option<f64>,
    disturbance: Option<f64>,
    disturbance_share: Option<f64>,
}

impl HardwareKeys {
    /// What drives the wheels; none where nothing says so, or how fast drivers turn them.
    fn drivers(&self, battery: &BatteryParams) -> Option<Drivers> {
        let motor = self.motor.as_ref();
        match &self.speed_driver {
            Some(driver) => {
                let friction = self.friction.unwrap_or_default();
                let speeds = driver.params(motor, &friction, battery.nominal_v)?;
                Some(Drivers::SpeedLoops(speeds, self.motor))
            }
            None => self.motor.map(Drivers::Bridges),
        }
    }

    /// The hardware, if any of it is described.
    pub fn hardware(&self, base: &BaseSpec, place: &Source<'_>) -> Checked<Option<Hardware>> {
        let by = match (self.motor, self.speed_driver) {
            (_, Some(_)) => "speed_driver",
            (Some(_), None) => "motor",
            (None, None) => {
                let given = [
                    ("battery", self.battery.is_some()),
                    ("friction", self.friction.is_some()),
                    ("encoder", self.encoder.is_some()),
                    ("pose_source", self.pose_source.is_some()),
                    ("gyro", self.gyro.is_some()),
                    ("control", self.control.is_some()),
                ];
                return match given.iter().find(|(_, is_given)| *is_given) {
                    Some((table, _)) => {
                        Err(place.error(table, "needs a [motor] or a [speed_driver] as well"))
                    }
                    None => Ok(None),
                };
            }
        };
        let missing = |table: &str| place.error(table, format!("is missing: [{by}] needs it"));
        let battery = match self.battery {
            Some(battery) => battery,
            None if self.motor.is_some() => return Err(missing("battery")),
            None => BatteryParams::default(),
        };
        let drivers = self.drivers(&battery).ok_or_else(|| {
            let key = "speed_driver.max_speed_rad_s";
            place.error(key, "is missing; with [motor] it is that without load")
        })?;
        let hardware = Hardware {
            drivers,
            battery,
            friction: self.friction.unwrap_or_default(),
            counts_per_turn: self
                .encoder
                .ok_or_else(|| missing("encoder"))?
                .counts_per_turn,
            speed_bandwidth: self.encoder.map_or_else(speed_bandwidth, |e| e.bandwidth),
            pose_source: self.pose_source,
            gyro: self.gyro.map(|keys| keys.gyro()),
            period_s: self.control.ok_or_else(|| missing("control"))?.period_s,
        };
        check(&hardware, base, place)?;
        Ok(Some(hardware))
    }
}

/// The plant's and the core's own checks, and that the motors give what the limits promise.
fn check(hardware: &Hardware, base: &BaseSpec, place: &Source<'_>) -> Checked<()> {
    let plant = hardware.world().params(&base.robot).check();
    plant.map_err(|error| plant_error(&error.key, &error, place))?;
    let wheels = &base.robot.wheels;
    let radius = base.smaller_radius_m();
    let limits = &base.limits;
    let driver = hardware
        .driver::<f64>(limits.speed, radius)
        .validate()
        .map_err(|error| place.param_error(driver_key(error.field), &error))?;
    let (fastest, how) = match &driver {
        Driver::Torques => (f64::INFINITY, ""),
        Driver::Motors(motor) => {
            let most = motor.max_torque_nm();
            if limits.wheel_torque_nm > most {
                let message = format!(
                    "is more than the {most:.3} N m that [motor] gives at its current limit, after friction"
                );
                return Err(place.error("limits.wheel_torque", message));
            }
            let fastest = motor.no_load_speed_rad_s() * radius;
            (fastest, "[motor] runs without load")
        }
        Driver::Speeds(speeds) => {
            let fastest = speeds.params().max_speed_rad_s * radius;
            (fastest, "[speed_driver] turns it at most")
        }
    };
    let turning = 0.5 * wheels.track_m * limits.turn_rate;
    for (key, rim) in [
        ("limits.speed", limits.speed),
        ("limits.turn_rate", turning),
        ("limits.rim_speed", limits.rim_speed),
    ] {
        if rim > fastest {
            let message = format!(
                "asks a wheel for {rim:.2} m/s, more than the {fastest:.2} m/s at which {how}"
            );
            return Err(place.error(key, message));
        }
    }
    if let Some(gyro) = &hardware.gyro {
        let params = gyro.params::<f64>();
        let checked = params.check();
        checked.map_err(|error| place.error(&gyro_key(error.field), param(&error)))?;
    }
    hardware
        .localiser::<f64>(wheels)
        .validate_with::<controller_core::maths::Libm>()
        .map_err(|error| place.error(localiser_key(error.field), param(&error)))?;
    let period = hardware.period_s;
    if !(1.0e-4..=0.1).contains(&period) {
        return Err(place.error("control.period_s", "must be in 1e-4 to 0.1"));
    }
    // The pose of this tick is one of those, and may be a tick from the one before it.
    let remembered = (REMEMBERED - 2) as f64 * period.max(LEAST_APART_S) + period;
    let most = (remembered - period) / OLDEST_POSE;
    match &hardware.pose_source {
        Some(source) if source.latency_s > most => {
            let message = format!(
                "is too old: a base remembers its way for {remembered:.3} s, and poses, which may be {OLDEST_POSE} times as old, may be {most:.3} s old"
            );
            Err(place.error("pose_source.latency_s", message))
        }
        _ => Ok(()),
    }
}

/// The plant's error of a key, which says the parameter's name if it is the same.
pub(super) fn plant_error(key: &str, error: &WorldError, place: &Source<'_>) -> ScenarioError {
    let WorldError {
        value, low, high, ..
    } = error;
    if key.ends_with(&error.key) {
        place.error(key, outside(*value, *low, *high))
    } else {
        place.error(key, error)
    }
}

/// The key that sets a parameter of what drives the wheels, or the table that does.
const fn driver_key(field: Field) -> &'static str {
    match field {
        Field::GearRatio => "motor.gear_ratio",
        Field::GearEfficiency => "motor.gear_efficiency",
        Field::TorqueConstant => "motor.kt_nm_per_a",
        Field::Resistance => "motor.resistance_ohm",
        Field::MaxCurrent => "motor.current_limit_a",
        Field::DeadBand => "motor.dead_band",
        Field::RotorInertia => "motor.rotor_inertia_kg_m2",
        Field::MaxWheelSpeed => "speed_driver.max_speed_rad_s",
        Field::MinWheelSpeed => "speed_driver.min_speed_rad_s",
        Field::DriverLag => "speed_driver.lag_s",
        Field::Supply => "battery.nominal_v",
        Field::CoulombFriction => "friction.coulomb_nm",
        Field::Stiction | Field::BreakawayTorque => "friction.static_nm",
        Field::ViscousFriction => "friction.viscous_nm_s",
        _ => "motor",
    }
}

/// The key that sets a parameter of the localiser, or the table that does.
const fn localiser_key(field: Field) -> &'static str {
    match field {
        Field::FixRate => "pose_source.rate_hz",
        Field::FixNoise => "pose_source.noise_m",
        Field::FixHeadingNoise => "pose_source.noise_rad",
        Field::CountsPerTurn => "encoder.counts_per_turn",
        _ => "encoder",
    }
}

/// The key that sets a parameter of the gyro.
fn gyro_key(field: Field) -> String {
    let name = field.name();
    let key = name.strip_prefix("gyro_").unwrap_or(name);
    format!("gyro.{key}")
}

impl GainKeys {
    /// `gains` but for the keys that are given; none if there is none.
    pub fn over(&self, gains: MotionGains<f64>) -> Option<MotionGains<f64>> {
        let mut tuned = gains;
        let mut any = false;
        for (field, key) in [
            (&mut tuned.decay, self.decay),
            (&mut tuned.longitudinal, self.longitudinal),
            (&mut tuned.longitudinal_bound, self.longitudinal_bound),
            (&mut tuned.heading, self.heading),
            (&mut tuned.lateral, self.lateral),
            (&mut tuned.slow, self.slow),
            (&mut tuned.approach, self.approach),
            (&mut tuned.approach_brake, self.approach_brake),
            (&mut tuned.speed_loop, self.speed_loop),
            (&mut tuned.turn_loop, self.turn_loop),
            (&mut tuned.disturbance, self.disturbance),
            (&mut tuned.disturbance_share, self.disturbance_share),
        ] {
            if let Some(value) = key {
                *field = value;
                any = true;
            }
        }
        any.then_some(tuned)
    }
}
