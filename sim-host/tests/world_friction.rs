//! Dry and viscous friction of `world` against closed forms.

use crate::world_common::*;
use sim_host::world::{Actuation, GRAVITY, PlantFault, Side, World, WorldParams, presets};

/// Coulomb 0.4 N m and viscous 0.05 N m s a wheel: 40 kg feel 8 N and 10 N s/m.
fn rough() -> WorldParams {
    let mut params = perfect();
    params.friction.coulomb_nm = 0.4;
    params.friction.static_nm = 0.6;
    params.friction.viscous_nm_s = 0.05;
    params
}

const MASS: f64 = 40.0;
const DRY: f64 = 8.0;
const VISCOUS: f64 = 10.0;

#[test]
fn a_coasting_robot_stops_where_the_closed_form_says() {
    // m v' = −F − c v: v = (v₀ + F/c) exp(−ct/m) − F/c, at rest after (m/c) ln(1 + c v₀/F), a way of
    // (m/c)(v₀ − (F/c) ln(1 + c v₀/F)).
    let (start, dry_speed) = (1.0, DRY / VISCOUS);
    let log = (1.0 + start / dry_speed).ln();
    let (time, way) = (
        MASS / VISCOUS * log,
        MASS / VISCOUS * (start - dry_speed * log),
    );
    let mut world = moving(&rough(), start, 0.0);
    run(&mut world, Actuation::Release, 1.0);
    let speed = (start + dry_speed) * (-VISCOUS / MASS).exp() - dry_speed;
    // Viscous friction is second order in 0.25 ms: (c h/m)²/12 a step.
    near(world.truth().twist.linear, speed, 1.0e-8);
    let mut ticks = 100;
    while world.truth().twist.linear > 0.0 {
        run(&mut world, Actuation::Release, 0.01);
        ticks += 1;
    }
    assert!(
        (0.01 * f64::from(ticks) - time).abs() <= 0.01,
        "{ticks} {time}"
    );
    // The last substep is cut short: at most v h with v < 0.2 m/s² · h.
    near(world.truth().pose.x, way, 1.0e-7);
    let end = world.truth();
    run(&mut world, Actuation::Release, 1.0);
    assert_eq!(world.truth(), end, "at rest is at rest");
}

#[test]
fn stiction_holds_below_and_breaks_above() {
    let mut world = at_rest(&rough());
    run(&mut world, torque(0.599, 0.599), 1.0);
    assert_eq!(world.truth().pose.x, 0.0);
    run(&mut world, torque(0.601, 0.601), 0.01);
    assert!(world.truth().twist.linear > 0.0);
    // Once it turns, Coulomb friction is all that holds it: it goes on below the static torque.
    run(&mut world, torque(0.5, 0.5), 10.0);
    let settling = 1.0 - (-VISCOUS / MASS * 10.0_f64).exp();
    near(world.truth().twist.linear, 2.0 / VISCOUS * settling, 2.0e-2);
}

#[test]
fn a_braking_torque_stops_at_zero_and_does_not_chatter() {
    let mut world = moving(&rough(), 0.3, 0.0);
    run(&mut world, torque(-0.3, -0.3), 3.0);
    assert_eq!(world.truth().twist.linear, 0.0);
    let wheels = world.wheel_speeds();
    assert_eq!((wheels.right, wheels.left), (0.0, 0.0));
}

#[test]
fn rolling_resistance_is_its_share_of_the_weight() {
    let mut params = perfect();
    params.friction.rolling = 0.02;
    let mut world = moving(&params, 1.0, 0.0);
    run(&mut world, Actuation::Release, 1.0);
    near(
        world.truth().twist.linear,
        1.0 - 0.02 * 30.0 * GRAVITY / MASS,
        1.0e-9,
    );
}

#[test]
fn a_robot_rests_on_a_slope_that_stiction_holds_and_rolls_on_a_steeper_one() {
    let mut params = rough();
    // 2 · 0.6 N m / 0.1 m = 12 N against 30 kg: sin α = 0.0408.
    params.floor.slope_rad = (12.0_f64 / (30.0 * GRAVITY)).asin() - 1.0e-4;
    let mut world = at_rest(&params);
    run(&mut world, Actuation::Release, 5.0);
    // Held wheels leave rounding of gravity against the floor's force.
    assert!(world.truth().pose.x.abs() < 1.0e-15);
    params.floor.slope_rad += 2.0e-4;
    let mut world = at_rest(&params);
    run(&mut world, Actuation::Release, 5.0);
    assert!(world.truth().pose.x > 0.5, "12 N drive it against 8 N");
}

#[test]
fn a_blocked_wheel_is_a_pivot() {
    let mut world = at_rest(&perfect());
    world.inject(PlantFault::WheelBlocked(Side::Left));
    run(&mut world, torque(1.0, 1.0), 1.0);
    let twist = world.truth().twist;
    // 10 N at 0.5 m from the pivot, on I + m (l/2)² + J l²/r².
    near(
        twist.angular,
        5.0 / (15.0 + 30.0 * 0.0625 + 5.0 * 0.25),
        1.0e-9,
    );
    near(twist.linear, 0.25 * twist.angular, 1.0e-9);
    world.heal(PlantFault::WheelBlocked(Side::Left));
    run(&mut world, torque(1.0, 1.0), 0.5);
    assert!(world.wheel_speeds().left > 0.0);
}

/// Kinetic energy.
fn energy(params: &WorldParams, world: &World) -> f64 {
    let b = &params.body;
    let twist = world.truth().twist;
    let across = world.sideways() + b.com_ahead_m * twist.angular;
    let motor = params.motor.expect("motors");
    let wheel = b.wheel_inertia_kg_m2 + motor.gear_ratio.powi(2) * motor.rotor_inertia_kg_m2;
    let turning = world.wheel_speeds();
    0.5 * (b.mass_kg * (twist.linear.powi(2) + across.powi(2))
        + b.inertia_com_kg_m2 * twist.angular.powi(2)
        + wheel * (turning.right.powi(2) + turning.left.powi(2)))
}

#[test]
fn nothing_that_is_not_driven_gains_energy() {
    for keys in [
        presets::hobby_1kg(),
        presets::lab_10kg(),
        presets::paper_30kg(),
    ] {
        for command in [Actuation::Release, Actuation::Brake] {
            let mut params = keys.params(&robot());
            params.floor.slope_rad = 0.0;
            // Skids at first: 3 m/s at 4 rad/s is 12 m/s², more than the grip of 5.
            let mut world = moving(&params, 3.0, 4.0);
            let first = energy(&params, &world);
            let mut last = first;
            for _ in 0..500 {
                run(&mut world, command, 0.01);
                let now = energy(&params, &world);
                // Tyres are springs: what they hold, k z²/2 below F²σ/(2CN), they may give back.
                assert!(now <= last + 0.05, "{last} to {now}");
                last = now;
            }
            // Rolling resistance alone takes 0.6 m/s of the 3.
            assert!(last < 0.7 * first, "{last} of {first} left after 5 s");
        }
    }
}
