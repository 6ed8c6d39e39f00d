//! The robot that is driven: a small base with two geared 12 V motors. Change it to yours, then do the bring-up of the
//! board's README from its first line.

use controller_core::handover::Reset;
use controller_core::motor::{MotorParams, WheelFriction};
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::params::{NeuronParams, Params, ParkingGains, Robot, TrackingGains};
use controller_core::wheels::WheelGeometry;
use firmware_demo::control::{LinkWatch, Settings, StallWatch};
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

/// The controller, until the host sets other parameters: gains G of the project, torque loops for this mass.
pub const PARAMS: Params<f32> = Params {
    robot: Robot {
        mass_kg: MASS_KG,
        inertia_kg_m2: INERTIA_KG_M2,
        wheels: WHEELS,
    },
    tracking: TrackingGains {
        k1: 0.9,
        k2: 6.0,
        k3: 2.0,
        k_d1: 3.0 * MASS_KG,
        k_d2: 5.0 * INERTIA_KG_M2,
    },
    parking: ParkingGains {
        k4: 1.2,
        k5: 1.2,
        k_c1: 3.0 * MASS_KG,
        k_c2: 5.0 * INERTIA_KG_M2,
    },
    neurons: NeuronParams {
        a: 4.0,
        b: 4.0,
        d: 4.0,
    },
    reset: Reset::TorqueContinuous,
    // Gear times torque constant times current limit is 0.255 N m.
    max_wheel_torque_nm: Some(0.25),
    max_tick_s: 0.01,
};

/// Encoder of 64 counts a motor turn.
pub const ODOMETRY: OdometryParams<f32> = OdometryParams {
    wheels: WHEELS,
    calibration: Calibration::NOMINAL,
    counts_per_turn: 64.0 * 30.0,
    bandwidth: 60.0,
};

/// When the control task gives up.
pub fn settings() -> Settings {
    Settings {
        period_us: PERIOD_US,
        late_us: PERIOD_US + PERIOD_US / 2,
        link: LinkWatch::StopAfterUs(100_000),
        stall: StallWatch {
            torque_nm: 0.15,
            speed_rad_s: 0.1,
            after_us: 500_000,
        },
        ..Settings::default()
    }
}
