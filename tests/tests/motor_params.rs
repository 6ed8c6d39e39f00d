//! The ranges of the motor's parameters, each at its ends.

use controller_core::error::Field;
use controller_core::motor::{MotorParams, WheelFriction};

#[test]
fn parameters_are_checked_one_by_one() {
    let good = MotorParams {
        gear_ratio: 20.0,
        gear_efficiency: 0.8,
        torque_constant_nm_per_a: 0.05,
        resistance_ohm: 2.0,
        supply_v: 20.0,
        max_current_a: 4.0,
        friction: WheelFriction {
            coulomb_nm: 0.1,
            stiction_nm: 0.0,
            viscous_nm_s: 0.01,
            blend_rad_s: 0.1,
        },
        dead_band: 0.02,
        rotor_inertia_kg_m2: 0.0,
    };
    assert!(good.validate().is_ok());
    type Place = fn(&mut MotorParams<f64>) -> &mut f64;
    let places: [(Field, Place, f64, f64); 10] = [
        (Field::GearRatio, |p| &mut p.gear_ratio, 0.1, 1e4),
        (Field::GearEfficiency, |p| &mut p.gear_efficiency, 0.2, 1.0),
        (
            Field::TorqueConstant,
            |p| &mut p.torque_constant_nm_per_a,
            1e-6,
            100.0,
        ),
        (Field::Resistance, |p| &mut p.resistance_ohm, 1e-4, 1e4),
        (Field::Supply, |p| &mut p.supply_v, 1.0, 1e3),
        (Field::MaxCurrent, |p| &mut p.max_current_a, 1e-3, 1e3),
        (
            Field::ViscousFriction,
            |p| &mut p.friction.viscous_nm_s,
            0.0,
            1e6,
        ),
        (
            Field::FrictionBlend,
            |p| &mut p.friction.blend_rad_s,
            1e-3,
            1e3,
        ),
        (Field::DeadBand, |p| &mut p.dead_band, 0.0, 0.5),
        (
            Field::RotorInertia,
            |p| &mut p.rotor_inertia_kg_m2,
            0.0,
            10.0,
        ),
    ];
    for (field, place, low, high) in places {
        for wrong in [f64::NAN, f64::INFINITY, low - 1e-7, high * 1.001] {
            let mut params = good;
            *place(&mut params) = wrong;
            assert_eq!(
                params.validate().expect_err("wrong").field,
                field,
                "{wrong}"
            );
        }
    }
    // Friction that the largest current does not overcome: 3.2 N m.
    let mut stuck = good;
    stuck.friction.coulomb_nm = 3.3;
    assert_eq!(
        stuck.validate().expect_err("stuck").field,
        Field::MaxCurrent
    );
    stuck.friction.coulomb_nm = -0.1;
    assert_eq!(
        stuck.validate().expect_err("wrong").field,
        Field::CoulombFriction
    );
    // Nothing to blend needs no blend; what a base finds is blended by one that is stated all the same.
    let mut plain = MotorParams {
        gear_efficiency: 1.0,
        friction: WheelFriction::NONE,
        ..good
    };
    assert!(plain.validate().is_ok());
    for (blend, fits) in [(1e-3, true), (1e3, true), (1e-4, false), (-0.1, false)] {
        plain.friction.blend_rad_s = blend;
        let found = plain.validate().err().map(|error| error.field);
        assert_eq!(found, (!fits).then_some(Field::FrictionBlend), "{blend}");
    }
}
