//! Motors, gears and friction.

use controller_core::motor::{MotorParams, WheelFriction};

use crate::constants::writer::{Writer, number};

pub(super) fn motor(out: &mut Writer, params: &MotorParams<f32>) {
    let MotorParams {
        gear_ratio,
        gear_efficiency,
        torque_constant_nm_per_a,
        resistance_ohm,
        supply_v,
        max_current_a,
        friction,
        dead_band,
    } = params;
    let WheelFriction {
        coulomb_nm,
        stiction_nm,
        viscous_nm_s,
        blend_rad_s,
    } = friction;
    out.open("motor: Some(motor::MotorParams {");
    out.number(
        "gear_ratio",
        *gear_ratio,
        "Turns of the motor per turn of the wheel.",
    );
    out.number("gear_efficiency", *gear_efficiency, "");
    let constant = number(*torque_constant_nm_per_a);
    out.field("torque_constant_nm_per_a", &constant, "[N m/A, V s/rad]");
    out.number("resistance_ohm", *resistance_ohm, "[ohm]");
    out.number("supply_v", *supply_v, "Nominal [V].");
    out.number("max_current_a", *max_current_a, "[A]");
    out.open("friction: motor::WheelFriction {");
    out.number("coulomb_nm", *coulomb_nm, "At the wheel [N m].");
    out.number(
        "stiction_nm",
        *stiction_nm,
        "To break loose, beyond that [N m].",
    );
    out.number("viscous_nm_s", *viscous_nm_s, "[N m s/rad]");
    out.number("blend_rad_s", *blend_rad_s, "[rad/s]");
    out.close("},");
    out.number("dead_band", *dead_band, "Share of the duty.");
    out.close("}),");
}
