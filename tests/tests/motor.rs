//! The motor layer: limits, symmetry, continuity, and a motor written on its own that gives back what was asked.

use controller_core::motor::{Motor, MotorParams, WheelDemand, WheelFriction};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

/// From a toy to a wheelchair: everything that a base could have.
fn params() -> impl Strategy<Value = MotorParams<f64>> {
    (
        (1.0..100.0, 0.3..=1.0, 0.003..0.3, 0.05..10.0, 5.0..48.0),
        (0.5..20.0, 0.0..0.5, 0.0..0.02, 0.05..2.0, 0.0..=0.5),
    )
        .prop_map(
            |((gear, eta, kt, ohm, volt), (amp, dry, wet, blend, dead))| {
                MotorParams {
                    gear_ratio: gear,
                    gear_efficiency: eta,
                    torque_constant_nm_per_a: kt,
                    resistance_ohm: ohm,
                    supply_v: volt,
                    max_current_a: amp,
                    friction: WheelFriction {
                        // Shares of the largest torque and of the torque at no load.
                        coulomb_nm: dry * eta * gear * kt * amp,
                        stiction_nm: 0.5 * dry * eta * gear * kt * amp,
                        viscous_nm_s: wet * (gear * kt) * (gear * kt) / ohm,
                        blend_rad_s: blend,
                    },
                    dead_band: dead,
                    rotor_inertia_kg_m2: 0.0,
                }
            },
        )
}

/// Torque in units of the largest, both speeds in units of no load.
fn demand() -> impl Strategy<Value = [f64; 3]> {
    [-1.5..1.5, -1.3..1.3, -1.3..1.3]
}

fn scaled(motor: &Motor<f64>, [torque, desired, speed]: [f64; 3]) -> WheelDemand<f64> {
    WheelDemand {
        torque_nm: torque * motor.max_torque_nm(),
        desired_speed_rad_s: desired * motor.no_load_speed_rad_s(),
        speed_rad_s: speed * motor.no_load_speed_rad_s(),
        beyond_coulomb_nm: None,
    }
}

/// Motor, gear, wheel and bridge as they are: torque that accelerates the base, from a duty.
///
/// Electrics by Kirchhoff, gear by power, friction by its own sense: nothing of the core's formulas.
fn base_torque(p: &MotorParams<f64>, duty: f64, supply: f64, speed: f64) -> f64 {
    let open = (duty.abs() - p.dead_band).max(0.0);
    let rotor_speed = p.gear_ratio * speed;
    let volt = supply * open * duty.signum() - p.torque_constant_nm_per_a * rotor_speed;
    let rotor_torque = p.torque_constant_nm_per_a * volt / p.resistance_ohm;
    let rotor_power = rotor_torque * rotor_speed;
    let wheel_power = if rotor_power > 0.0 {
        rotor_power * p.gear_efficiency
    } else {
        rotor_power / p.gear_efficiency
    };
    let friction = &p.friction;
    wheel_power / speed - friction.coulomb_nm * speed.signum() - friction.viscous_nm_s * speed
}

fn cases(seed: u64) -> Config {
    Config {
        cases: 4000,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..Config::default()
    }
}

proptest! {
    #![proptest_config(cases(0x6d6f_746f))]

    /// At the nominal supply, at 80 % of it and full: what is not limited is exact but for rounding, beyond both blends.
    #[test]
    fn a_motor_gives_back_the_torque_that_was_asked(p in params(), asked in demand(), charge in 0.8..1.15) {
        let motor = p.validate().expect("in range");
        let mut demand = scaled(&motor, asked);
        // Both speeds on the same side, the desired one beyond the blend and the wheel broken loose.
        let past = demand.desired_speed_rad_s.abs() + 10.0 * p.friction.blend_rad_s;
        demand.speed_rad_s = past.copysign(demand.speed_rad_s);
        demand.desired_speed_rad_s = demand.speed_rad_s;
        let supply = charge * p.supply_v;
        let command = motor.command(&demand, supply);
        prop_assert!(!command.limited.supply_unknown);
        let given = base_torque(&p, command.duty, supply, demand.speed_rad_s);
        let scale = motor.max_torque_nm() + p.friction.coulomb_nm
            + supply * p.gear_ratio * p.torque_constant_nm_per_a / p.resistance_ohm / p.gear_efficiency;
        let short = if (command.voltage_v / supply).abs() < 0.25 * p.dead_band {
            // In the ramp the bridge gives up to a quarter of the dead band too little.
            0.25 * p.dead_band
        } else {
            0.0
        };
        // Some ten operations on numbers below `scale`; the gear's model divides by the speed.
        let tolerance = scale * (1e-12 + short);
        // Reported, limited or not: gear torque less friction is what accelerates the base.
        let accelerating = command.torque_nm - command.friction_nm;
        prop_assert!((given - accelerating).abs() <= tolerance, "{given} {accelerating} {command:?}");
        if !command.limited.torque() {
            prop_assert!((given - demand.torque_nm).abs() <= tolerance, "{given} {demand:?}");
        }
    }

    /// A standing wheel gets its stiction on top, with the sense of the desired speed, and none without one.
    #[test]
    fn a_standing_wheel_gets_what_breaks_it_loose(p in params(), asked in demand()) {
        let motor = p.validate().expect("in range");
        let mut demand = scaled(&motor, asked);
        demand.speed_rad_s = 0.0;
        demand.desired_speed_rad_s = p.friction.blend_rad_s.copysign(asked[1]);
        let friction = &p.friction;
        let all = friction.coulomb_nm + friction.stiction_nm + friction.viscous_nm_s * friction.blend_rad_s;
        let given = motor.command(&demand, p.supply_v).friction_nm;
        // Three sums and a division by the blend.
        prop_assert!((given - all.copysign(asked[1])).abs() <= 1e-14 * all, "{given} {all}");
        demand.desired_speed_rad_s = 0.0;
        prop_assert_eq!(motor.command(&demand, p.supply_v).friction_nm, 0.0);
    }

    #[test]
    fn limits_hold_and_are_told(p in params(), asked in demand(), charge in 0.3..2.5) {
        let motor = p.validate().expect("in range");
        let demand = scaled(&motor, asked);
        let measured = charge * p.supply_v;
        let command = motor.command(&demand, measured);
        let limited = command.limited;
        // 1e-9: the ends themselves, which rounding of charge * supply may miss.
        if (0.5 + 1e-9..2.0 - 1e-9).contains(&charge) {
            prop_assert!(!limited.supply_unknown);
        } else if !(0.5 - 1e-9..2.0 + 1e-9).contains(&charge) {
            prop_assert!(limited.supply_unknown);
        }
        let supply = if limited.supply_unknown { p.supply_v } else { measured };
        prop_assert!(command.duty.abs() <= 1.0);
        // What the dead band leaves of it.
        let supply = (1.0 - p.dead_band) * supply;
        prop_assert!(command.voltage_v.abs() <= supply * (1.0 + 1e-15));
        prop_assert!(!limited.invalid);
        let emf = p.gear_ratio * p.torque_constant_nm_per_a * demand.speed_rad_s;
        let runaway = emf.abs() > supply + p.resistance_ohm * p.max_current_a;
        prop_assert_eq!(limited.overspeed, runaway);
        if !runaway {
            prop_assert!(command.current_a.abs() <= p.max_current_a, "{:?}", command);
        } else {
            prop_assert!(limited.voltage);
        }
        // What is not reported as limited is what was asked, to the bit.
        let whole = demand.torque_nm + command.friction_nm;
        if !limited.torque() {
            prop_assert_eq!(command.torque_nm, whole);
        } else if (command.torque_nm - whole).abs() > 1e-9 * whole.abs() {
            // And what differs is reported (the reverse of the line above).
            prop_assert!(limited.current || limited.voltage);
        }
    }

    #[test]
    fn odd_and_rising_with_the_torque(p in params(), asked in demand(), more in 0.0..0.5) {
        let motor = p.validate().expect("in range");
        let demand = scaled(&motor, asked);
        let opposite = WheelDemand {
            torque_nm: -demand.torque_nm,
            desired_speed_rad_s: -demand.desired_speed_rad_s,
            speed_rad_s: -demand.speed_rad_s,
            ..demand
        };
        let (there, back) = (motor.command(&demand, p.supply_v), motor.command(&opposite, p.supply_v));
        prop_assert_eq!(there.duty, -back.duty);
        prop_assert_eq!(there.torque_nm, -back.torque_nm);
        prop_assert_eq!(there.current_a, -back.current_a);
        prop_assert_eq!(there.limited, back.limited);
        let harder = WheelDemand { torque_nm: demand.torque_nm + more * motor.max_torque_nm(), ..demand };
        let harder = motor.command(&harder, p.supply_v);
        prop_assert!(harder.duty >= there.duty);
        // Rounding where the limit changes the formula.
        let rounding = 1e-12 * there.torque_nm.abs();
        prop_assert!(harder.torque_nm >= there.torque_nm - rounding);
    }

    /// The constants in the documentation of `Motor::command`, for steps of any size, so through every kink.
    #[test]
    fn duty_is_continuous_as_documented(p in params(), a in demand(), b in demand(), near in 1e-6..1.0) {
        let motor = p.validate().expect("in range");
        let mix = |from: f64, to: f64| from + near * (to - from);
        let b = [mix(a[0], b[0]), mix(a[1], b[1]), mix(a[2], b[2])];
        let (from, to) = (scaled(&motor, a), scaled(&motor, b));
        let (k, eta) = (p.gear_ratio * p.torque_constant_nm_per_a, p.gear_efficiency);
        let slope = if p.dead_band > 0.0 { 5.0 } else { 1.0 };
        let (r, u, friction) = (p.resistance_ohm, p.supply_v, &p.friction);
        let per_torque = slope * r / (eta * k * u);
        let release = 10.0 * friction.blend_rad_s;
        let per_speed = slope * (k + r * friction.stiction_nm / (release * eta * k)) / u;
        let per_wanted = slope * r / u
            * (((friction.coulomb_nm + friction.stiction_nm) / friction.blend_rad_s + friction.viscous_nm_s) / (eta * k)
                + (1.0 / (eta * eta) - 1.0) * p.max_current_a / (2.0 * friction.blend_rad_s));
        let most = per_torque * (to.torque_nm - from.torque_nm).abs()
            + per_speed * (to.speed_rad_s - from.speed_rad_s).abs()
            + per_wanted * (to.desired_speed_rad_s - from.desired_speed_rad_s).abs();
        let step = motor.command(&to, u).duty - motor.command(&from, u).duty;
        // Rounding of numbers up to the voltage asked for, some hundred times the supply.
        prop_assert!(step.abs() <= most * (1.0 + 1e-9) + 1e-11, "{step} {most}");
    }

    #[test]
    fn rest_is_exactly_zero_and_nonsense_is_told(p in params(), wrong in prop_oneof![Just(f64::NAN), Just(f64::INFINITY)]) {
        let motor = p.validate().expect("in range");
        let rest = motor.command(&WheelDemand::default(), 0.8 * p.supply_v);
        prop_assert_eq!(rest, Default::default());
        for demand in [
            WheelDemand { torque_nm: wrong, ..WheelDemand::default() },
            WheelDemand { desired_speed_rad_s: wrong, ..WheelDemand::default() },
            WheelDemand { speed_rad_s: -wrong, ..WheelDemand::default() },
        ] {
            let command = motor.command(&demand, p.supply_v);
            // A desired speed without end is a sense of motion like any other, unless it is a torque as well.
            let harmless = command.duty.abs() <= 1.0 && command.torque_nm.is_finite();
            prop_assert!(harmless && (command.limited.invalid || command.limited.current), "{:?}", command);
        }
        let unknown = motor.command(&WheelDemand::default(), wrong);
        prop_assert!(unknown.limited.supply_unknown);
        prop_assert_eq!(unknown.duty, 0.0);
    }
}

/// Noise of the measured speed at rest comes out as its back-EMF and no more: friction does not see it.
#[test]
fn noise_at_rest_is_not_magnified_by_friction() {
    let p: MotorParams<f64> = MotorParams {
        gear_ratio: 30.0,
        gear_efficiency: 0.7,
        torque_constant_nm_per_a: 0.0085,
        resistance_ohm: 2.2,
        supply_v: 12.0,
        max_current_a: 2.0,
        friction: WheelFriction {
            coulomb_nm: 0.05,
            stiction_nm: 0.0,
            viscous_nm_s: 1e-3,
            blend_rad_s: 0.2,
        },
        dead_band: 0.05,
        rotor_inertia_kg_m2: 0.0,
    };
    let motor = p.validate().expect("in range");
    // One count of 1920 a turn, through odometry with 60 rad/s at 1 kHz: 12 mrad/s.
    let noisy = WheelDemand {
        speed_rad_s: 0.012,
        ..WheelDemand::default()
    };
    let command = motor.command(&noisy, 12.0);
    assert_eq!(command.torque_nm, 0.0);
    // Inside the dead band: the bridge does nothing.
    assert!(command.duty.abs() < 0.05 * p.dead_band);
}

/// Friction that a base finds is compensated by a motor whose file states none, in the sense of the desired speed; without a blend nothing is.
#[test]
fn friction_that_is_found_is_compensated_where_none_is_stated() {
    let stating_none = |blend_rad_s| MotorParams {
        gear_ratio: 30.0,
        gear_efficiency: 1.0,
        torque_constant_nm_per_a: 0.0085,
        resistance_ohm: 2.2,
        supply_v: 12.0,
        max_current_a: 1.0,
        friction: WheelFriction {
            blend_rad_s,
            ..WheelFriction::NONE
        },
        dead_band: 0.0,
        rotor_inertia_kg_m2: 0.0,
    };
    for (blend, way, share) in [(0.02, 0.05, 1.0), (0.02, -0.01, -0.5), (0.0, 0.05, 0.0)] {
        let motor: Motor<f64> = stating_none(blend).validate().expect("in range");
        let found = WheelDemand {
            desired_speed_rad_s: way,
            beyond_coulomb_nm: Some(0.03),
            ..WheelDemand::default()
        };
        let command = motor.command(&found, 12.0);
        assert_eq!(command.friction_nm, share * 0.03);
        // 0.255 N m/A, all of it from the friction.
        let expected = share * 0.03 / (30.0 * 0.0085);
        assert!((command.current_a - expected).abs() < 1e-12);
    }
}
