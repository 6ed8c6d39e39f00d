//! Battery, drivers and motors of `world` against closed forms.

use crate::world_common::*;
use sim_host::world::{Actuation, ActuationError, PlantFault};

/// Torque per current at the wheel.
const K: f64 = 1.5;
const OHM: f64 = 0.5;
const BATTERY_OHM: f64 = 0.05;
/// Half of 30 kg and the wheel, at 0.1 m.
const HALF: f64 = 0.15 + WHEEL;

#[test]
fn constant_duty_ends_at_the_speed_where_sag_and_friction_balance() {
    let mut params = with_motor();
    params.friction.viscous_nm_s = 0.02;
    let d = 0.6;
    let mut world = at_rest(&params);
    run(&mut world, duty(d), 20.0);
    // K i = c ω with R i = D V − K ω and V = V₀ − 2 R_b D i.
    let per_current = OHM + 2.0 * BATTERY_OHM * d * d;
    let omega = d * 24.0 / (K + 0.02 * per_current / K);
    near(world.wheel_speeds().right, omega, 1.0e-9);
    near(world.currents()[0], 0.02 * omega / K, 1.0e-8);
    near(
        world.supply_v(),
        24.0 - 2.0 * BATTERY_OHM * d * 0.02 * omega / K,
        1.0e-9,
    );
}

#[test]
fn a_stalled_motor_draws_what_resistances_leave_and_no_more_than_its_limit() {
    let mut params = with_motor();
    params.friction.static_nm = 1.0e3;
    params.motor.as_mut().expect("motors").inductance_h = 1.0e-3;
    let mut world = at_rest(&params);
    run(&mut world, duty(1.0), 1.0);
    near(
        world.currents()[1],
        24.0 / (OHM + 2.0 * BATTERY_OHM),
        1.0e-9,
    );
    params.motor.as_mut().expect("motors").current_limit_a = 10.0;
    let mut world = at_rest(&params);
    run(&mut world, duty(1.0), 1.0);
    assert_eq!(world.currents(), [10.0, 10.0]);
    // The power of both motors: V (24 − V)/R_b = 2 · 0.5 · 100.
    near(
        world.supply_v() * (24.0 - world.supply_v()) / BATTERY_OHM,
        100.0,
        1.0e-9,
    );
}

#[test]
fn the_electrical_brake_is_an_exponential() {
    let mut world = moving(&with_motor(), 1.0, 0.0);
    run(&mut world, Actuation::Brake, 0.05);
    // K²/R = 4.5 N m s on 0.2 kg m²: 22.5 1/s. The end share follows the idle wheel's exponential
    // (90 1/s), which leaves z/12 of z² too much: 2e-3 · 22.5 · 0.25 ms · 1.1.
    near(
        world.truth().twist.linear,
        (-K * K / OHM / HALF * 0.05).exp(),
        5.0e-5,
    );
}

#[test]
fn a_dead_band_does_nothing() {
    let mut params = with_motor();
    params.motor.as_mut().expect("motors").dead_band = 0.1;
    let mut world = at_rest(&params);
    run(&mut world, duty(0.1), 1.0);
    assert_eq!(world.truth().pose.x, 0.0);
    run(&mut world, duty(0.6), 20.0);
    near(world.wheel_speeds().right, 0.5 * 24.0 / K, 1.0e-9);
}

#[test]
fn a_gear_takes_its_share() {
    let mut params = with_motor();
    params.motor.as_mut().expect("motors").gear_efficiency = 0.8;
    let mut world = at_rest(&params);
    run(&mut world, torque(1.0, 1.0), 1.0);
    near(world.truth().twist.linear, 0.8 * 0.1 / HALF, 1.0e-9);
}

#[test]
fn the_speed_loop_is_a_first_order_lag_and_integrates_a_load_away() {
    for mut params in [perfect(), with_motor()] {
        let command = Actuation::Speed {
            right: -2.0,
            left: 2.0,
        };
        let lag = if params.motor.is_some() { 0.05 } else { 0.02 };
        params.speed_loop_s = lag;
        let mut world = at_rest(&params);
        run(&mut world, command, 0.05);
        // The loop's model is exact, the wheel second order: 1e-4 of a 0.25 ms step in 20 ms.
        near(
            world.wheel_speeds().left,
            2.0 * -(-0.05 / lag).exp_m1(),
            1.0e-3,
        );
        params.friction.coulomb_nm = 1.0;
        let mut world = at_rest(&params);
        run(&mut world, command, 3.0);
        near(world.wheel_speeds().left, 2.0, 1.0e-9);
    }
}

#[test]
fn faults_of_the_drive_act_and_are_told() {
    let mut world = at_rest(&with_motor());
    run(&mut world, torque(1.0, 1.0), 0.5);
    world.inject(PlantFault::DriveFails { coast: false });
    run(&mut world, torque(-1.0, -1.0), 0.5);
    near(world.truth().twist.linear, 0.1 / HALF, 1.0e-9);
    assert!(world.drive_answer().is_err());
    world.inject(PlantFault::DriveFails { coast: true });
    run(&mut world, torque(-1.0, -1.0), 0.5);
    near(world.truth().twist.linear, 0.1 / HALF, 1.0e-9);
    world.heal_all();
    assert!(world.drive_answer().is_ok());
    world.inject(PlantFault::BatterySag { volts: 9.0 });
    run(&mut world, Actuation::Release, 0.01);
    near(world.supply_v(), 9.0, 1.0e-12);
}

#[test]
fn commands_that_cannot_be_move_nothing() {
    let mut world = at_rest(&perfect());
    let before = world.truth();
    for (command, error) in [
        (torque(f64::NAN, 0.0), ActuationError::NotFinite),
        (duty(0.5), ActuationError::NoMotor),
    ] {
        assert_eq!(world.advance(&command, TICK_US), Err(error));
    }
    assert_eq!(
        world.advance(&Actuation::Release, 0),
        Err(ActuationError::BadTick)
    );
    let mut driven = at_rest(&with_motor());
    assert_eq!(
        driven.advance(&duty(1.1), TICK_US),
        Err(ActuationError::DutyAboveOne)
    );
    assert_eq!((world.truth(), world.now_us()), (before, 0));
}
