//! What there is to the plant: plain tables, SI units, defaults of a perfect world.

use super::sense_params::{EncoderParams, GyroParams, NoiseParams, PoseSourceParams, TickParams};
use serde::Deserialize;

/// Standard gravity \[m/s²\].
pub const GRAVITY: f64 = 9.806_65;

/// A whole plant. [`WorldKeys`](super::WorldKeys) makes one from a file and a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldParams {
    /// Masses and lengths.
    pub body: BodyParams,
    /// Both motors; none for ideal sources of torque.
    pub motor: Option<MotorParams>,
    /// Time constant of drivers that close their own speed loop \[s\].
    pub speed_loop_s: f64,
    /// What feeds the motors.
    pub battery: BatteryParams,
    /// Bearings and tyres.
    pub friction: FrictionParams,
    /// Grip and slope.
    pub floor: FloorParams,
    /// Pushes from outside.
    pub push: Vec<PushParams>,
    /// Wheel encoders.
    pub encoder: EncoderParams,
    /// External localisation, if there is one.
    pub pose_source: Option<PoseSourceParams>,
    /// Gyro, if there is one.
    pub gyro: Option<GyroParams>,
    /// Errors of what the driver measures.
    pub noise: NoiseParams,
    /// How evenly ticks come.
    pub tick: TickParams,
    /// Longest integration step \[µs\], 1 to 10,000.
    pub substep_us: u32,
}

/// Default of [`WorldParams::substep_us`]: an eighth of the fastest mechanical time constant of
/// the [`presets`](super::presets) (an idling motor, 4 ms). Substeps are of second order but where a wheel slips or breaks loose,
/// windings and current limits are exact, stiff tyres implicit: what the presets drive in 10 s is good to 0.4 mm, to 4 mm where
/// wheels slip.
pub const SUBSTEP_US: u32 = 500;

/// Default of [`WorldParams::speed_loop_s`]: what a driver reaches that closes
/// its loop at 1 kHz on an encoder of some hundred counts \[s\].
pub const SPEED_LOOP_S: f64 = 0.02;

/// Least of it: a driver cannot hold a wheel more stiffly than its own ticks let it.
pub const LEAST_LOOP_S: f64 = 1.0e-3;

/// The body on its two wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParams {
    /// Mass of everything \[kg\], wheels as well.
    pub mass_kg: f64,
    /// Moment of inertia about the vertical through the centre of mass \[kg m²\].
    pub inertia_com_kg_m2: f64,
    /// Distance of the centre of mass ahead of the axle \[m\]; negative behind it.
    pub com_ahead_m: f64,
    /// Rolling radius of the right wheel \[m\].
    pub radius_right_m: f64,
    /// Rolling radius of the left wheel \[m\].
    pub radius_left_m: f64,
    /// Distance between the wheels \[m\].
    pub track_m: f64,
    /// Moment of inertia of each wheel about its own axle, without the rotor \[kg m²\], above 0.
    pub wheel_inertia_kg_m2: f64,
    /// Share of the weight that the driven wheels carry, above 0 to 1; casters carry the rest.
    pub load_share: f64,
    /// Share of the driven wheels' load on the right one, 0.05 to 0.95.
    pub load_right: f64,
}

/// A brushed motor, its gear and its driver: the same for both wheels but for `strength`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorParams {
    /// Turns of the motor per turn of the wheel.
    pub gear_ratio: f64,
    /// Share of the torque that gets through the gear, above 0 to 1.
    #[serde(default = "one")]
    pub gear_efficiency: f64,
    /// Torque constant of the motor \[N m/A\], which is also its voltage constant \[V s/rad\].
    pub kt_nm_per_a: f64,
    /// Resistance of winding, brushes, leads and switches \[Ω\].
    pub resistance_ohm: f64,
    /// Inductance \[H\]; 0 lets the current follow at once.
    #[serde(default)]
    pub inductance_h: f64,
    /// Moment of inertia of the rotor, at the motor \[kg m²\].
    #[serde(default)]
    pub rotor_inertia_kg_m2: f64,
    /// Current at which the driver holds a motor \[A\].
    #[serde(default = "endless")]
    pub current_limit_a: f64,
    /// Share of the full duty that is lost at either sign, 0 to below 1: (|D| − band) acts.
    #[serde(default)]
    pub dead_band: f64,
    /// Factors on the torque constant of the right and the left motor.
    #[serde(default = "alike")]
    pub strength: [f64; 2],
}

impl MotorParams {
    /// Moment of inertia of the rotor as the wheel feels it, n² J_m \[kg m²\].
    pub fn rotor_at_wheel_kg_m2(&self) -> f64 {
        self.gear_ratio * self.gear_ratio * self.rotor_inertia_kg_m2
    }
}

/// The battery: an ideal source behind a resistance.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BatteryParams {
    /// Voltage on the label, what a controller without a measurement assumes \[V\].
    pub nominal_v: f64,
    /// Voltage without load \[V\]; the nominal one if it is left out.
    pub open_circuit_v: Option<f64>,
    /// Resistance of cells, fuse and leads \[Ω\].
    pub internal_ohm: f64,
}

impl Default for BatteryParams {
    /// 12 V, stiff.
    fn default() -> Self {
        Self {
            nominal_v: 12.0,
            open_circuit_v: None,
            internal_ohm: 0.0,
        }
    }
}

/// What holds a wheel back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrictionParams {
    /// Torque that a wheel at rest withstands \[N m\], at least `coulomb_nm`.
    pub static_nm: f64,
    /// Torque against the motion of a turning wheel \[N m\].
    pub coulomb_nm: f64,
    /// Torque per speed of the wheel \[N m s/rad\].
    pub viscous_nm_s: f64,
    /// Rolling resistance: force against rolling per load, no unit.
    pub rolling: f64,
}

/// The floor and how tyres hold on it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FloorParams {
    /// Largest horizontal force of a wheel per its load, above 0; infinite never slips.
    pub mu: f64,
    /// Slope \[rad\], 0 to 0.7.
    pub slope_rad: f64,
    /// Direction in which it goes down \[rad\], from the x axis.
    pub downhill_rad: f64,
    /// Force per slip ratio and load of a tyre, no unit; 0 for a rigid one.
    pub slip_stiffness: f64,
    /// Way over which a tyre's force follows its slip \[m\].
    pub relaxation_m: f64,
    /// Places or times with another grip; the last that holds counts.
    pub patch: Vec<PatchParams>,
}

impl Default for FloorParams {
    /// Level, endless grip, rigid tyres.
    fn default() -> Self {
        Self {
            mu: f64::INFINITY,
            slope_rad: 0.0,
            downhill_rad: 0.0,
            slip_stiffness: 0.0,
            relaxation_m: 0.01,
            patch: Vec::new(),
        }
    }
}

/// A wheel inside the rectangle and the time window has this grip instead of the floor's.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatchParams {
    /// Grip, as [`FloorParams::mu`].
    pub mu: f64,
    /// From and to in x \[m\].
    #[serde(default = "everywhere")]
    pub x_m: [f64; 2],
    /// From and to in y \[m\].
    #[serde(default = "everywhere")]
    pub y_m: [f64; 2],
    /// From and to in time \[s\].
    #[serde(default = "everywhere")]
    pub time_s: [f64; 2],
}

/// A push at the centre of mass for some time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushParams {
    /// From and to \[s\].
    pub time_s: [f64; 2],
    /// Force along the world's x \[N\].
    #[serde(default)]
    pub force_x_n: f64,
    /// Force along the world's y \[N\].
    #[serde(default)]
    pub force_y_n: f64,
    /// Moment about the vertical \[N m\], counter-clockwise.
    #[serde(default)]
    pub moment_nm: f64,
}

fn one() -> f64 {
    1.0
}

fn endless() -> f64 {
    f64::INFINITY
}

fn alike() -> [f64; 2] {
    [1.0, 1.0]
}

fn everywhere() -> [f64; 2] {
    [f64::NEG_INFINITY, f64::INFINITY]
}
