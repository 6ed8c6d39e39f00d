//! A motor on outputs of a board.

use controller_core::motor::{Motor, MotorParams, WheelFriction};
use firmware_demo::drive::MotorSide;

/// Gear 20, 0.05 N m/A: 1 N m at the wheel is 1 A, with 2 Ω 2 V of 20 V; 1 rad/s is 1 V.
pub fn motor() -> Motor<f32> {
    let params = MotorParams {
        gear_ratio: 20.0,
        gear_efficiency: 1.0,
        torque_constant_nm_per_a: 0.05,
        resistance_ohm: 2.0,
        supply_v: 20.0,
        max_current_a: 4.0,
        friction: WheelFriction::NONE,
        dead_band: 0.0,
        rotor_inertia_kg_m2: 0.0,
    };
    params.validate().unwrap()
}

pub fn side<P, D>(pwm: P, direction: D) -> MotorSide<P, D> {
    MotorSide { pwm, direction }
}
