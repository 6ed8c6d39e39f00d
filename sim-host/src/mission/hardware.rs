//! What a base has beside its body: motors, battery, encoders, a localisation.

use crate::world::{
    BatteryParams, EncoderParams, FrictionParams, GyroParams as TrueGyro, LEAST_LOOP_S,
    MotorParams as TrueMotor, PoseSourceParams, WorldKeys,
};
use controller_core::gyro::GyroParams;
use controller_core::localiser::{FusionParams, LocaliserParams};
use controller_core::motor::{DriverParams, MotorParams, SpeedParams, WheelFriction};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::scalar::Scalar;
use controller_core::wheels::WheelGeometry;

/// A busy pose source is up to so many times as old as its file says.
pub const OLDEST_POSE: f64 = 1.5;

/// Hardware of a base, as its data sheets and an identification have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hardware {
    /// What drives the wheels.
    pub drivers: Drivers,
    /// Battery.
    pub battery: BatteryParams,
    /// Friction at the wheels.
    pub friction: FrictionParams,
    /// Encoder counts per turn of a wheel.
    pub counts_per_turn: f64,
    /// Bandwidth of the speed estimate \[rad/s\].
    pub speed_bandwidth: f64,
    /// External localisation, if there is one.
    pub pose_source: Option<PoseSourceParams>,
    /// Gyro, if there is one.
    pub gyro: Option<Gyro>,
    /// Control period \[s\].
    pub period_s: f64,
}

/// What drives the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drivers {
    /// Motors on bridges, which the base commands by duty.
    Bridges(TrueMotor),
    /// Drivers that close their own speed loop; their motors where they are known.
    SpeedLoops(SpeedParams<f64>, Option<TrueMotor>),
}

impl Drivers {
    /// Both motors, where they are known.
    pub const fn motor(&self) -> Option<&TrueMotor> {
        match self {
            Self::Bridges(motor) | Self::SpeedLoops(_, Some(motor)) => Some(motor),
            Self::SpeedLoops(_, None) => None,
        }
    }
}

/// A gyro, and what the base makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyro {
    /// The sensor.
    pub sensor: TrueGyro,
    /// See [`GyroParams::rest_s`].
    pub rest_s: f64,
    /// See [`GyroParams::carry_s`].
    pub carry_s: f64,
}

impl Gyro {
    /// The core's gyro.
    pub fn params<T: Scalar>(&self) -> GyroParams<T> {
        let (f, sensor) = (T::from_f64, &self.sensor);
        GyroParams {
            noise_density: f(sensor.noise_density),
            bias_limit: f(sensor.bias_limit),
            bias_walk: f(sensor.bias_walk),
            scale_error: f(sensor.scale_error),
            range: f(sensor.range),
            resolution: f(sensor.resolution),
            rate_hz: f(sensor.rate_hz),
            latency_s: f(sensor.latency_s),
            rest_s: f(self.rest_s),
            carry_s: f(self.carry_s),
        }
    }
}

/// Wanted speed of a wheel, as a share of that at the base's largest speed, up to which friction
/// compensation rises.
///
/// A goal is approached at k₄ e, so a blend of v leaves friction uncompensated within e = v/k₄: a
/// thousandth is below 2 mm for the bases here. With a hundredth most runs end stuck beside the goal.
const BLEND_SHARE: f64 = 0.001;

/// Torque to break a standing wheel loose, as a share of what its file says; see [`breakaway_nm`].
///
/// Bearings differ by a third with load, wear and cold. A wheel with too little compensation stands until the
/// disturbance estimate has gathered the rest, tens of seconds on a light base; one with too much
/// turns, and within a few ticks its encoder takes the excess away. At ±30 % of friction 8 of 90 runs of the 1 kg
/// base ended beside the goal with 1.0, none with 1.15 to 1.5.
const BREAK_LOOSE: f64 = 1.3;

/// The most that it takes to break a wheel with such friction loose \[N m\].
pub fn breakaway_nm(friction: &FrictionParams) -> f64 {
    BREAK_LOOSE * friction.static_nm
}

impl Hardware {
    /// What drives a base of this largest speed \[m/s\] and wheel radius \[m\], for the core.
    pub fn driver<T: Scalar>(&self, speed: f64, radius: f64) -> DriverParams<T> {
        let f = T::from_f64;
        match &self.drivers {
            Drivers::Bridges(motor) => DriverParams::Motors(self.motor_layer(motor, speed, radius)),
            Drivers::SpeedLoops(speeds, _) => DriverParams::Speeds(SpeedParams {
                max_speed_rad_s: f(speeds.max_speed_rad_s),
                min_speed_rad_s: f(speeds.min_speed_rad_s),
                lag_s: f(speeds.lag_s),
                breakaway_nm: f(speeds.breakaway_nm),
            }),
        }
    }

    /// The core's motor layer. Rolling resistance is not known to a motor; it is left to the disturbance estimate.
    fn motor_layer<T: Scalar>(&self, motor: &TrueMotor, speed: f64, radius: f64) -> MotorParams<T> {
        let f = T::from_f64;
        let friction = &self.friction;
        let stiction = breakaway_nm(friction) - friction.coulomb_nm;
        MotorParams {
            gear_ratio: f(motor.gear_ratio),
            gear_efficiency: f(motor.gear_efficiency),
            torque_constant_nm_per_a: f(motor.kt_nm_per_a),
            resistance_ohm: f(motor.resistance_ohm),
            supply_v: f(self.battery.nominal_v),
            max_current_a: f(motor.current_limit_a),
            friction: WheelFriction {
                coulomb_nm: f(friction.coulomb_nm),
                stiction_nm: f(stiction.max(0.0)),
                viscous_nm_s: f(friction.viscous_nm_s),
                blend_rad_s: f(BLEND_SHARE * speed / radius),
            },
            dead_band: f(motor.dead_band),
            rotor_inertia_kg_m2: f(motor.rotor_inertia_kg_m2),
        }
    }

    /// The core's localiser on these wheels.
    pub fn localiser<T: Scalar>(&self, wheels: &WheelGeometry<f64>) -> LocaliserParams<T> {
        let f = T::from_f64;
        LocaliserParams {
            odometry: OdometryParams {
                wheels: wheels.cast(),
                calibration: Calibration::NOMINAL,
                counts_per_turn: f(self.counts_per_turn),
                bandwidth: f(self.speed_bandwidth),
            },
            fusion: self.pose_source.map(|source| {
                FusionParams::for_source(f(source.noise_m), f(source.noise_rad), f(source.rate_hz))
            }),
            gyro: self.gyro.map(|gyro| gyro.params()),
        }
    }

    /// This hardware on a perfect floor.
    pub fn world(&self) -> WorldKeys {
        let plain = WorldKeys::default();
        WorldKeys {
            motor: self.drivers.motor().copied(),
            speed_loop_s: match self.drivers {
                Drivers::SpeedLoops(SpeedParams { lag_s, .. }, _) => lag_s.max(LEAST_LOOP_S),
                Drivers::Bridges(_) => plain.speed_loop_s,
            },
            battery: self.battery,
            friction: self.friction,
            encoder: EncoderParams {
                counts_per_turn: self.counts_per_turn,
                ..EncoderParams::default()
            },
            pose_source: self.pose_source,
            gyro: self.gyro.map(|gyro| gyro.sensor),
            ..plain
        }
    }
}
