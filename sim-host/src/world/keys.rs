//! The table `[world]` of a file: what is not said is perfect.

use super::params::{
    BatteryParams, BodyParams, FloorParams, FrictionParams, MotorParams, PushParams, SPEED_LOOP_S,
    SUBSTEP_US, WorldParams,
};
use super::sense_params::{EncoderParams, GyroParams, NoiseParams, PoseSourceParams, TickParams};
use controller_core::robot::Robot;
use serde::Deserialize;

/// `[world]`, key for key; units are in the names. Ranges are checked by
/// [`World::new`](super::World::new).
///
/// ```
/// use controller_core::{robot::Robot, types::Measured};
/// use sim_host::world::{World, WorldKeys};
///
/// let keys: WorldKeys = toml::from_str(
///     "[body]\nmass_factor = 1.3\n[floor]\nmu = 0.6\n[pose_source]\nrate_hz = 20.0\nlatency_s = 0.05",
/// )?;
/// let params = keys.params(&Robot::paper());
/// let world = World::new(&params, &Measured::default(), 1)?;
/// # let _ = world;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WorldKeys {
    /// `[world.body]`: how the true robot differs from the one that the controller believes in.
    pub body: BodyKeys,
    /// `[world.motor]`; without it torques are ideal.
    pub motor: Option<MotorParams>,
    /// As [`WorldParams::speed_loop_s`].
    pub speed_loop_s: f64,
    /// `[world.battery]`.
    pub battery: BatteryParams,
    /// `[world.friction]`.
    pub friction: FrictionParams,
    /// `[world.floor]` with `[[world.floor.patch]]`.
    pub floor: FloorParams,
    /// `[[world.push]]`.
    pub push: Vec<PushParams>,
    /// `[world.encoder]`.
    pub encoder: EncoderParams,
    /// `[world.pose_source]`; without it no pose comes.
    pub pose_source: Option<PoseSourceParams>,
    /// A gyro.
    pub gyro: Option<GyroParams>,
    /// `[world.noise]`.
    pub noise: NoiseParams,
    /// `[world.tick]`.
    pub tick: TickParams,
    /// Longest integration step \[µs\], 250.
    pub substep_us: u32,
}

impl Default for WorldKeys {
    /// The perfect world.
    fn default() -> Self {
        Self {
            body: BodyKeys::default(),
            motor: None,
            speed_loop_s: SPEED_LOOP_S,
            battery: BatteryParams::default(),
            friction: FrictionParams::default(),
            floor: FloorParams::default(),
            push: Vec::new(),
            encoder: EncoderParams::default(),
            pose_source: None,
            gyro: None,
            noise: NoiseParams::default(),
            tick: TickParams::default(),
            substep_us: SUBSTEP_US,
        }
    }
}

/// `[world.body]`. Factors are on the values of `[robot]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BodyKeys {
    /// On the mass.
    pub mass_factor: f64,
    /// On the moment of inertia about the axle's middle.
    pub inertia_factor: f64,
    /// On the right radius.
    pub radius_right_factor: f64,
    /// On the left radius.
    pub radius_left_factor: f64,
    /// On the track.
    pub track_factor: f64,
    /// Centre of mass ahead of the axle \[m\].
    pub com_ahead_m: f64,
    /// Of each wheel about its axle \[kg m²\]; the wheels then turn beside the robot's mass and
    /// inertia. Left out, a thousandth of the mass is taken for their turning, and all together
    /// is what `[robot]` says.
    pub wheel_inertia_kg_m2: Option<f64>,
    /// As [`BodyParams::load_share`].
    pub load_share: f64,
    /// As [`BodyParams::load_right`].
    pub load_right: f64,
}

impl Default for BodyKeys {
    /// As believed.
    fn default() -> Self {
        Self {
            mass_factor: 1.0,
            inertia_factor: 1.0,
            radius_right_factor: 1.0,
            radius_left_factor: 1.0,
            track_factor: 1.0,
            com_ahead_m: 0.0,
            wheel_inertia_kg_m2: None,
            load_share: 1.0,
            load_right: 0.5,
        }
    }
}

/// Share of the mass that each wheel's turning is taken for if nothing is said: small enough that a
/// slipping wheel is all but massless, large enough to be integrated.
const WHEEL_SHARE: f64 = 1.0e-3;

impl WorldKeys {
    /// The plant of a robot under these keys.
    pub fn params(&self, robot: &Robot<f64>) -> WorldParams {
        WorldParams {
            body: self.body.params(robot),
            motor: self.motor,
            speed_loop_s: self.speed_loop_s,
            battery: self.battery,
            friction: self.friction,
            floor: self.floor.clone(),
            push: self.push.clone(),
            encoder: self.encoder,
            pose_source: self.pose_source,
            gyro: self.gyro,
            noise: self.noise,
            tick: self.tick,
            substep_us: self.substep_us,
        }
    }
}

impl BodyKeys {
    /// The body. `[robot]` has its inertia about the axle's middle: I = I_c + m d² + (l/2)² 2J/r²,
    /// and its mass m + 2J/r², where the wheels' turning counts if it is not given apart.
    fn params(&self, robot: &Robot<f64>) -> BodyParams {
        let wheels = &robot.wheels;
        let radius_right_m = wheels.radius_right_m * self.radius_right_factor;
        let radius_left_m = wheels.radius_left_m * self.radius_left_factor;
        let track_m = wheels.track_m * self.track_factor;
        let whole_kg = robot.mass_kg * self.mass_factor;
        let whole_kg_m2 = robot.inertia_kg_m2 * self.inertia_factor;
        let lever = 0.25 * track_m * track_m;
        let (wheel, turning_kg) = self.wheel_inertia_kg_m2.map_or_else(
            || {
                // Nor may it be more than a part of a very slender robot's inertia.
                let slender = (whole_kg_m2 / (whole_kg * lever)).min(1.0);
                let each_kg = WHEEL_SHARE * slender * whole_kg;
                (each_kg * radius_right_m * radius_left_m, 2.0 * each_kg)
            },
            |wheel| (wheel, 0.0),
        );
        let mass_kg = whole_kg - turning_kg;
        let off_centre = mass_kg * self.com_ahead_m * self.com_ahead_m;
        BodyParams {
            mass_kg,
            inertia_com_kg_m2: whole_kg_m2 - off_centre - turning_kg * lever,
            com_ahead_m: self.com_ahead_m,
            radius_right_m,
            radius_left_m,
            track_m,
            wheel_inertia_kg_m2: wheel,
            load_share: self.load_share,
            load_right: self.load_right,
        }
    }
}

/// The world of a mission, if it is not the ideal plant.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSetup {
    /// The true plant; `body` are factors on the robot that the controller believes in.
    pub world: WorldKeys,
    /// Settles all noise.
    pub seed: u64,
}
