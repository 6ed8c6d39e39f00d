//! The body of `world`: the ideal plant as its limit, conservation, Coriolis terms, slope.

use crate::world_common::*;
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use sim_host::plant::Plant;
use sim_host::world::{Actuation, GRAVITY, World, WorldKeys, WorldParams};

/// Energy of body and wheels.
fn energy(params: &WorldParams, world: &World) -> f64 {
    let b = &params.body;
    let Twist { linear, angular } = world.truth().twist;
    let sideways = world.sideways() + b.com_ahead_m * angular;
    let wheels = world.wheel_speeds();
    let rotor = params
        .motor
        .map_or(0.0, |m| m.gear_ratio.powi(2) * m.rotor_inertia_kg_m2);
    let turning = (b.wheel_inertia_kg_m2 + rotor) * (wheels.right.powi(2) + wheels.left.powi(2));
    0.5 * (b.mass_kg * (linear.powi(2) + sideways.powi(2))
        + b.inertia_com_kg_m2 * angular.powi(2)
        + turning)
}

#[test]
fn the_perfect_world_is_the_ideal_plant() {
    let start = Measured {
        pose: Pose::new(0.2, -0.1, 2.0),
        twist: Twist::new(0.5, -1.0),
    };
    let params = WorldKeys::default().params(&robot());
    let mut world = World::new(&params, &start, 0).expect("a plant");
    let mut plant = Plant::new(robot(), &start);
    for tick in 0..1000 {
        let t = 0.01 * f64::from(tick);
        let torques = WheelTorques {
            right: 2.0 * (0.7 * t).sin(),
            left: 2.0 * (1.1 * t).cos(),
        };
        plant.advance(&torques, 0.01);
        world
            .advance(&torque(torques.right, torques.left), TICK_US)
            .expect("a command");
    }
    let (world, plant) = (world.truth(), plant.truth());
    // Speeds are exact but for rounding of 40,000 substeps at some 1e-16 each.
    assert!((world.twist.linear - plant.twist.linear).abs() < 1.0e-11);
    assert!((world.twist.angular - plant.twist.angular).abs() < 1.0e-11);
    assert!((world.pose.theta - plant.pose.theta).abs() < 1.0e-10);
    // The midpoint's h²/24 max|f''| T = 2.6e-9 · 5 · 10 with v w² up to 5 m/s³.
    assert!(
        (world.pose.x - plant.pose.x).abs() < 1.5e-7,
        "{world:?} {plant:?}"
    );
    assert!(
        (world.pose.y - plant.pose.y).abs() < 1.5e-7,
        "{world:?} {plant:?}"
    );
}

#[test]
fn turning_wheels_add_to_mass_and_inertia() {
    let params = perfect();
    let mut world = at_rest(&params);
    run(&mut world, torque(2.0, 2.0), 1.0);
    // m + 2J/r² = 30 + 10.
    near(world.truth().twist.linear, 40.0 / 40.0, 1.0e-10);
    let mut world = at_rest(&params);
    run(&mut world, torque(2.0, -2.0), 1.0);
    // 40 N at 0.25 m on 15 + 2 · 5 · 0.25².
    near(world.truth().twist.angular, 10.0 / 15.625, 1.0e-10);
}

#[test]
fn a_coasting_body_with_its_mass_off_centre_keeps_energy() {
    let mut params = perfect();
    params.body.com_ahead_m = 0.15;
    let mut world = moving(&params, 1.0, 2.0);
    let start = energy(&params, &world);
    let mut least = f64::INFINITY;
    for _ in 0..2000 {
        run(&mut world, Actuation::Release, 0.01);
        // Held tyres do no work; the rotation is taken at a mid that is known to O(h²).
        near(energy(&params, &world), start, 1.0e-6);
        least = least.min(world.truth().twist.angular);
        // d w² pushes forward, d u w turns against w: mass ahead straightens the way.
    }
    assert!(world.truth().twist.linear > 1.0 && least < 0.02);
}

#[test]
fn without_grip_momentum_is_kept() {
    let mut params = perfect();
    params.body.com_ahead_m = 0.1;
    params.floor.mu = 1.0e-3;
    // Nothing but a trace of floor: 1e-3 · 9.8 m/s² for 1 s.
    let mut world = moving(&params, 2.0, 5.0);
    let velocity = |world: &World| {
        let Measured { pose, twist } = world.truth();
        let across = world.sideways() + 0.1 * twist.angular;
        let (s, c) = pose.theta.sin_cos();
        [twist.linear * c - across * s, twist.linear * s + across * c]
    };
    let start = velocity(&world);
    run(&mut world, Actuation::Release, 1.0);
    let end = velocity(&world);
    let lost = (start[0] - end[0]).hypot(start[1] - end[1]);
    assert!(lost < 1.0e-3 * GRAVITY * 1.001, "{lost}");
    // Moment of the floor: at most mu m g at half the track and the lever d, on 15 kg m².
    let moment = 1.0e-3 * 30.0 * GRAVITY * 0.25_f64.hypot(0.1);
    assert!((world.truth().twist.angular - 5.0).abs() < 1.01 * moment / 15.0);
    assert_eq!(world.slipping(), [true; 2]);
}

#[test]
fn the_off_centre_mass_follows_its_equations() {
    let mut params = perfect();
    let d = 0.1;
    params.body.com_ahead_m = d;
    let mut world = moving(&params, 1.0, 1.0);
    let (mut u, mut w) = (1.0, 1.0);
    // (m + 2J/r²) u' = F + m d w², (I + m d² + 2J b²/r²) w' = M − m d u w by fine steps of Heun's.
    let rate = |u: f64, w: f64| {
        (
            (10.0 + 30.0 * d * w * w) / 40.0,
            (2.5 - 30.0 * d * u * w) / (15.0 + 30.0 * d * d + 0.625),
        )
    };
    let h = 1.0e-5;
    for _ in 0..200_000 {
        let (a, b) = rate(u, w);
        let (c, e) = rate(u + h * a, w + h * b);
        (u, w) = (u + 0.5 * h * (a + c), w + 0.5 * h * (b + e));
    }
    run(&mut world, torque(1.0, 0.0), 2.0);
    // Second order in 0.25 ms with rates of some 1/s: 1e-8.
    near(world.truth().twist.linear, u, 1.0e-7);
    near(world.truth().twist.angular, w, 1.0e-7);
    assert!(world.sideways().abs() < 1.0e-12);
}

#[test]
fn a_slope_pulls_by_its_sine_along_and_sideways_is_held() {
    let mut params = perfect();
    params.floor.slope_rad = 0.1;
    params.floor.downhill_rad = 0.6;
    let mut world = at_rest(&params);
    run(&mut world, Actuation::Release, 1.0);
    let along = 30.0 * GRAVITY * 0.1_f64.sin() * 0.6_f64.cos();
    near(world.truth().twist.linear, along / 40.0, 1.0e-9);
    assert_eq!(world.truth().pose.theta, 0.0);
    let held: f64 = world.floor_forces().iter().map(|force| force[1]).sum();
    near(
        held,
        -30.0 * GRAVITY * 0.1_f64.sin() * 0.6_f64.sin(),
        1.0e-9,
    );
}

#[test]
fn a_push_acts_in_its_window_only() {
    let mut params = perfect();
    params.push = vec![sim_host::world::PushParams {
        time_s: [0.5, 0.75],
        force_x_n: 80.0,
        force_y_n: 50.0,
        moment_nm: 0.0,
    }];
    let mut world = at_rest(&params);
    run(&mut world, Actuation::Release, 0.5);
    assert_eq!(world.truth().twist.linear, 0.0);
    run(&mut world, Actuation::Release, 0.5);
    // 80 N on 40 kg for a quarter of a second.
    near(world.truth().twist.linear, 0.5, 1.0e-9);
}
