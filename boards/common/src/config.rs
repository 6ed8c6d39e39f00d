//! The robot that is driven: a small base with two geared 12 V motors. Change it to yours, then do the bring-up of the
//! board's README from its first line.

use controller_core::base::BaseParams;
use controller_core::error::ParamError;
use controller_core::localiser::LocaliserParams;
use controller_core::motion::{Limits, Policy};
use controller_core::motor::{MotorParams, WheelFriction};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::robot::Robot;
use controller_core::wheels::WheelGeometry;
use firmware_demo::drive::OffPhase;

/// Control period \[us\].
pub const PERIOD_US: u32 = 1000;
/// Of so many reports one is sent.
pub const DECIMATE: u16 = 20;
/// The watchdog resets the chip after this long without ticks \[ms\].
pub const WATCHDOG_MS: u32 = 50;
/// PWM frequency \[Hz\]: above hearing, and slow enough for a common bridge.
pub const PWM_HZ: u32 = 20_000;

const MASS_KG: f32 = 1.5;
const INERTIA_KG_M2: f32 = 0.012;

/// Wheels of 65 mm, 160 mm apart.
pub const WHEELS: WheelGeometry<f32> = WheelGeometry {
    radius_right_m: 0.0325,
    radius_left_m: 0.0325,
    track_m: 0.160,
};

/// Gear 30:1; 5.5 A and 1.4 N m at stall under 12 V. The current limit is far below, for the first trials.
///
/// Gear loss, friction and dead band are those of a perfect motor until they have been measured: nothing is compensated
/// then, and nothing is overdone.
pub const MOTOR: MotorParams<f32> = MotorParams {
    gear_ratio: 30.0,
    gear_efficiency: 1.0,
    torque_constant_nm_per_a: 0.0085,
    resistance_ohm: 2.2,
    supply_v: 12.0,
    max_current_a: 1.0,
    friction: WheelFriction::NONE,
    dead_band: 0.0,
};

/// What the bridges do while their PWM is low; those of the board's README short the motors.
pub const OFF_PHASE: OffPhase = OffPhase::Shorted;

/// Mass, inertia and wheels.
pub const ROBOT: Robot<f32> = Robot {
    mass_kg: MASS_KG,
    inertia_kg_m2: INERTIA_KG_M2,
    wheels: WHEELS,
};

/// What the base may do: walking pace, and torques that the current limit allows.
pub const LIMITS: Limits<f32> = Limits {
    speed: 0.8,
    turn_rate: 4.0,
    accel: 0.8,
    brake: 1.0,
    turn_accel: 8.0,
    jerk: 20.0,
    turn_jerk: 100.0,
    // Gear times torque constant times current limit is 0.255 N m.
    wheel_torque_nm: 0.25,
    policy: Policy::KeepCurvature,
};

/// Encoder of 64 counts a motor turn.
pub const ODOMETRY: OdometryParams<f32> = OdometryParams {
    wheels: WHEELS,
    calibration: Calibration::NOMINAL,
    counts_per_turn: 64.0 * 30.0,
    bandwidth: 60.0,
};

/// Everything about the base, until the host sets other parameters: gains, tolerances and thresholds follow from the above.
///
/// # Errors
///
/// A value out of its range.
pub fn params() -> Result<BaseParams<f32>, ParamError> {
    let localiser = LocaliserParams {
        odometry: ODOMETRY,
        fusion: None,
    };
    BaseParams::new(ROBOT, LIMITS, localiser, Some(MOTOR), PERIOD_US)
}
