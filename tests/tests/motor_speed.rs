//! Wheel speeds for drivers with their own speed loop, and the ways of stopping.

use controller_core::error::{Field, Input, StepFault};
use controller_core::motor::{
    MotorParams, SpeedParams, SpeedState, WheelFriction, coast, electrical_brake,
};
use controller_core::robot::Robot;
use controller_core::types::{Accel, Twist};
use controller_core::wheels::{WheelGeometry, WheelMap};

const WHEELS: WheelGeometry<f64> = WheelGeometry {
    radius_right_m: 0.1,
    radius_left_m: 0.1,
    track_m: 0.5,
};

const OUTPUT: SpeedParams<f64> = SpeedParams {
    max_speed_rad_s: 10.0,
    min_speed_rad_s: 0.4,
    lag_s: 0.05,
    breakaway_nm: 0.0,
};

#[test]
fn speeds_are_led_limited_on_the_same_curve_and_told() {
    let (output, map) = (
        OUTPUT.validate().unwrap(),
        WheelMap::from_geometry(&WHEELS).unwrap(),
    );
    let mut state = SpeedState::default();
    let still = Accel::default();
    let command = output
        .command(
            &mut state,
            &map,
            &Twist::new(0.5, 0.0),
            &Accel::new(2.0, 0.0),
        )
        .unwrap();
    // (0.5 + 0.05 * 2)/0.1.
    assert!(
        (command.speeds.right - 6.0).abs() < 1e-12 && command.speeds.left == command.speeds.right
    );
    assert_eq!(command.limited, Default::default());
    let fast = Twist::new(1.5, 2.0);
    let command = output.command(&mut state, &map, &fast, &still).unwrap();
    assert!(command.limited.speed && !command.limited.slow);
    assert_eq!(command.speeds.right, 10.0);
    let driven = map.twist(&command.speeds);
    // Rounding of numbers of order 1.
    assert!(
        (driven.angular / driven.linear - 2.0 / 1.5).abs() < 1e-12,
        "the curvature is kept"
    );
    let before = state;
    for (command, rate, fault) in [
        (
            Twist::new(f64::NAN, 0.0),
            still,
            StepFault::NotFinite(Input::Reference),
        ),
        (
            Twist::new(0.0, 0.0),
            Accel::new(0.0, f64::INFINITY),
            StepFault::NotFinite(Input::Reference),
        ),
        (Twist::new(f64::MAX, 0.0), still, StepFault::Overflow),
    ] {
        assert_eq!(
            output.command(&mut state, &map, &command, &rate),
            Err(fault)
        );
        assert_eq!(state, before);
    }
}

/// A slow ripple about every threshold starts and stops a wheel once at most, and no speed is commanded that is not executed.
#[test]
fn the_slowest_speed_does_not_chatter() {
    let (output, map) = (
        OUTPUT.validate().unwrap(),
        WheelMap::from_geometry(&WHEELS).unwrap(),
    );
    let slowest = OUTPUT.min_speed_rad_s;
    for mean in (-30..=30).map(|step| 0.05 * slowest * f64::from(step)) {
        let mut state = SpeedState::default();
        let (mut changes, mut last) = (0, 0.0_f64);
        for tick in 0..1000 {
            // 0.24 of the slowest either way: just less than the hysteresis.
            let ripple = if tick % 2 == 0 { 0.24 } else { -0.24 } * slowest;
            let wanted = mean + ripple;
            let command = output
                .command(
                    &mut state,
                    &map,
                    &Twist::new(0.1 * wanted, 0.0),
                    &Accel::default(),
                )
                .unwrap();
            let speed = command.speeds.right;
            assert!(speed == 0.0 || speed.abs() >= slowest);
            assert!((speed - wanted).abs() <= 0.75 * slowest + 1e-12);
            assert_eq!(command.limited.slow, (speed - wanted).abs() > 1e-12);
            changes += usize::from((speed == 0.0) != (last == 0.0));
            last = speed;
        }
        assert!(changes <= 1, "{mean}: {changes}");
    }
    let mut state = SpeedState::default();
    let rest = output
        .command(&mut state, &map, &Twist::default(), &Accel::default())
        .unwrap();
    assert_eq!(rest, Default::default());
}

#[test]
fn speed_parameters_are_checked() {
    for (params, field) in [
        (
            SpeedParams {
                max_speed_rad_s: 0.0,
                ..OUTPUT
            },
            Field::MaxWheelSpeed,
        ),
        (
            SpeedParams {
                min_speed_rad_s: 5.1,
                ..OUTPUT
            },
            Field::MinWheelSpeed,
        ),
        (
            SpeedParams {
                min_speed_rad_s: -0.1,
                ..OUTPUT
            },
            Field::MinWheelSpeed,
        ),
        (
            SpeedParams {
                lag_s: f64::NAN,
                ..OUTPUT
            },
            Field::DriverLag,
        ),
        (
            SpeedParams {
                breakaway_nm: -0.1,
                ..OUTPUT
            },
            Field::BreakawayTorque,
        ),
    ] {
        assert_eq!(params.validate().unwrap_err().field, field);
    }
}

fn base() -> (MotorParams<f64>, Robot<f64>) {
    let motor = MotorParams {
        gear_ratio: 30.0,
        gear_efficiency: 0.7,
        torque_constant_nm_per_a: 0.01,
        resistance_ohm: 2.0,
        supply_v: 12.0,
        max_current_a: 3.0,
        friction: WheelFriction {
            coulomb_nm: 0.03,
            stiction_nm: 0.0,
            viscous_nm_s: 2e-3,
            blend_rad_s: 0.1,
        },
        dead_band: 0.0,
        rotor_inertia_kg_m2: 0.0,
    };
    let robot = Robot {
        mass_kg: 5.0,
        inertia_kg_m2: 0.08,
        ..Robot::paper()
    };
    (motor, robot)
}

/// Wheel by wheel through Newton's law, with 10 µs steps: the ways are never longer than said, and as long where the
/// bound is exact.
#[test]
fn ways_of_stopping_are_bounds() {
    let (params, robot) = base();
    let motor = params.validate().unwrap();
    let (r, arm) = (robot.wheels.radius_right_m, 0.5 * robot.wheels.track_m);
    let kappa = 0.3 * 0.3 / 2.0;
    // Force or moment on the base per unit of speed, for both wheels; and what moves.
    let roll = |start: f64, arm: f64, inert: f64, damping: f64, dry: f64| {
        let (mut speed, mut way, h) = (start, 0.0, 1e-5);
        for _ in 0..10_000_000 {
            let wheel = speed * arm / r;
            let torque = damping * wheel + dry;
            let next = speed - h * 2.0 * torque / r * arm / inert;
            if next <= 1e-9 {
                break;
            }
            way += 0.5 * h * (speed + next);
            speed = next;
        }
        way
    };
    let brake = electrical_brake(&motor, &robot).unwrap();
    for (decay, arm, inert) in [
        (brake.linear, 1.0, robot.mass_kg),
        (brake.angular, arm, robot.inertia_kg_m2),
    ] {
        let bound = decay.distance(-0.7).unwrap();
        let free = roll(0.7, arm, inert, kappa, 0.0);
        // The integration's step over the time constant, some 1e-4.
        assert!((free / bound - 1.0).abs() < 1e-3, "{free} {bound}");
        assert!(roll(0.7, arm, inert, kappa / 0.7, 0.03) < bound);
    }
    let released = coast(&motor, &robot).unwrap();
    for (decay, arm, inert) in [
        (released.linear, 1.0, robot.mass_kg),
        (released.angular, arm, robot.inertia_kg_m2),
    ] {
        let way = roll(0.7, arm, inert, 2e-3, 0.03);
        let bound = decay.distance(0.7).unwrap();
        // Never longer, and at most a factor of 2 shorter: each of both causes alone is left out.
        assert!(way < bound && way > 0.5 * bound, "{way} {bound}");
    }
    let slick = MotorParams {
        gear_efficiency: 1.0,
        friction: WheelFriction::NONE,
        ..params
    };
    let endless = coast(&slick.validate().unwrap(), &robot).unwrap();
    assert_eq!(endless.linear.distance(1.0), None);
    assert_eq!(endless.linear.time_constant_s(), None);
    let nothing = Robot {
        mass_kg: 0.0,
        ..robot
    };
    assert_eq!(coast(&motor, &nothing).unwrap_err().field, Field::Mass);
}
