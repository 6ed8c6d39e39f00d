//! The friction circle of `world`: where wheels let go, and what they do then.

use crate::world_common::*;
use sim_host::world::{Actuation, GRAVITY, PatchParams, PlantFault, Side, WorldParams};

fn grip(mu: f64) -> WorldParams {
    let mut params = perfect();
    params.floor.mu = mu;
    params
}

#[test]
fn the_largest_acceleration_is_mu_g() {
    let mu = 0.4;
    // Each wheel: f = mu m g/2 on the ground, r f + J (mu g)/r at its axle.
    let limit = 0.1 * mu * 15.0 * GRAVITY + WHEEL * mu * GRAVITY / 0.1;
    let mut world = at_rest(&grip(mu));
    run(&mut world, torque(0.999 * limit, 0.999 * limit), 0.5);
    assert_eq!(world.slipping(), [false; 2]);
    near(
        world.truth().twist.linear,
        0.999 * mu * GRAVITY * 0.5,
        1.0e-9,
    );
    let wheels = world.wheel_speeds();
    near(0.1 * wheels.right, world.truth().twist.linear, 1.0e-12);
    let mut world = at_rest(&grip(mu));
    run(&mut world, torque(2.0 * limit, 2.0 * limit), 0.5);
    assert_eq!(world.slipping(), [true; 2]);
    near(world.truth().twist.linear, mu * GRAVITY * 0.5, 1.0e-9);
    // The wheel: J ω' = 2 limit − r f.
    let spin = (2.0 * limit - 0.1 * mu * 15.0 * GRAVITY) / WHEEL * 0.5;
    near(world.wheel_speeds().left, spin, 1.0e-9);
    near(world.torques().right, 0.1 * mu * 15.0 * GRAVITY, 1.0e-9);
}

#[test]
fn the_fastest_corner_is_the_root_of_mu_g_radius() {
    let (mu, radius) = (0.5, 2.0);
    let limit = (mu * GRAVITY * radius).sqrt();
    for (share, skids) in [(0.999, false), (1.001, true)] {
        let speed = share * limit;
        let mut world = moving(&grip(mu), speed, speed / radius);
        run(&mut world, Actuation::Release, 0.01);
        assert_eq!(world.slipping() != [false; 2], skids, "{share}");
        assert_eq!(world.sideways().abs() > 1.0e-6, skids);
    }
    // Well above it, it skids outward, to the right of a left turn, until it is slow enough.
    let mut world = moving(&grip(mu), 1.3 * limit, 1.3 * limit / radius);
    run(&mut world, Actuation::Release, 0.1);
    assert!(world.sideways() < -0.05);
    run(&mut world, Actuation::Release, 5.0);
    assert_eq!(world.slipping(), [false; 2]);
    let twist = world.truth().twist;
    assert!(twist.linear * twist.angular <= mu * GRAVITY);
}

#[test]
fn forces_stay_on_the_circle_and_against_the_slip() {
    let mu = 0.3;
    let params = grip(mu);
    let mut world = moving(&params, 2.0, 2.0);
    for _ in 0..20 {
        run(&mut world, torque(20.0, 15.0), 0.01);
        let wheels = world.wheel_speeds();
        let twist = world.truth().twist;
        for (i, [f, y]) in world.floor_forces().into_iter().enumerate() {
            near(f.hypot(y), mu * 15.0 * GRAVITY, 1.0e-9);
            let (turning, lever) = [(wheels.right, 0.25), (wheels.left, -0.25)][i];
            let ahead = 0.1 * turning - twist.linear - lever * twist.angular;
            // Parallel to the slip (ahead, −sideways), and the same way.
            let slip = ahead.hypot(world.sideways());
            let across = f * world.sideways() + y * ahead;
            assert!(across.abs() < 1.0e-6 * slip * f.hypot(y), "{across}");
            assert!(f * ahead - y * world.sideways() > 0.0);
        }
    }
}

#[test]
fn a_braked_robot_slides_by_mu_g_and_then_rests() {
    let mu = 0.4;
    let mut world = moving(&grip(mu), 1.0, 0.0);
    world.inject(PlantFault::WheelBlocked(Side::Right));
    world.inject(PlantFault::WheelBlocked(Side::Left));
    run(&mut world, Actuation::Release, 0.1);
    near(world.truth().twist.linear, 1.0 - mu * GRAVITY * 0.1, 1.0e-9);
    run(&mut world, Actuation::Release, 1.0);
    assert!(world.truth().twist.linear.abs() < 1.0e-12);
    // v²/(2 mu g); the last substep is cut short.
    near(world.truth().pose.x, 0.5 / (mu * GRAVITY), 1.0e-6);
}

#[test]
fn across_a_slope_it_slides_where_the_tangent_is_above_mu() {
    for (slope, slides) in [(0.39, false), (0.41, true)] {
        let mut params = grip(0.4);
        params.floor.slope_rad = f64::atan(slope);
        params.floor.downhill_rad = std::f64::consts::FRAC_PI_2;
        let mut world = at_rest(&params);
        run(&mut world, Actuation::Release, 1.0);
        if slides {
            let gain = f64::atan(slope).sin() - 0.4 * f64::atan(slope).cos();
            near(world.sideways(), GRAVITY * gain, 1.0e-6);
        } else {
            assert!(world.truth().pose.y.abs() < 1.0e-12);
        }
    }
}

#[test]
fn one_wheel_on_ice_turns_the_robot() {
    let mut world = at_rest(&grip(0.8));
    world.inject(PlantFault::WheelOnIce {
        side: Side::Left,
        mu: 0.01,
    });
    run(&mut world, torque(3.0, 3.0), 0.3);
    assert_eq!(world.slipping(), [false, true]);
    assert!(world.truth().twist.angular > 0.05);
    near(world.torques().left, 0.1 * 0.01 * 15.0 * GRAVITY, 1.0e-9);
}

#[test]
fn a_patch_holds_where_and_when_it_lies() {
    let mut params = grip(0.8);
    params.floor.patch = vec![PatchParams {
        mu: 0.01,
        x_m: [0.5, 1.0],
        y_m: [0.0, 1.0],
        time_s: [0.0, 100.0],
    }];
    let mut world = at_rest(&params);
    let mut slips = [0; 2];
    while world.truth().pose.x < 0.95 {
        run(&mut world, torque(2.0, 2.0), 0.01);
        for (slip, count) in world.slipping().into_iter().zip(&mut slips) {
            *count += usize::from(slip);
        }
        if world.truth().pose.x < 0.5 {
            assert_eq!(slips, [0, 0]);
        }
    }
    // The left wheel drives at y = 0.25, the right one beside the patch.
    assert!(slips[1] > 5 && slips[0] == 0, "{slips:?}");
}

#[test]
fn a_soft_tyre_creeps_by_force_over_stiffness() {
    let mut params = grip(0.8);
    params.floor.slip_stiffness = 20.0;
    params.friction.viscous_nm_s = 0.05;
    let mut world = at_rest(&params);
    run(&mut world, torque(0.5, 0.5), 60.0);
    // Steady: nothing pulls on the body, so nothing slips.
    near(
        0.1 * world.wheel_speeds().right,
        world.truth().twist.linear,
        1.0e-9,
    );
    // A pull of 40 N at constant speed: F = C N κ, κ = slip / tread.
    params.floor.slope_rad = 0.1;
    params.floor.downhill_rad = std::f64::consts::PI;
    let mut world = at_rest(&params);
    run(&mut world, torque(2.0, 2.0), 60.0);
    let load = 30.0 * GRAVITY * 0.1_f64.cos();
    let force = 30.0 * GRAVITY * 0.1_f64.sin();
    let tread = 0.1 * world.wheel_speeds().right;
    let slip = (tread - world.truth().twist.linear) / tread;
    near(slip, force / (20.0 * load), 1.0e-6);
    // And at rest a tyre holds: no creep on a slope with the wheels blocked.
    let mut world = at_rest(&params);
    world.inject(PlantFault::WheelBlocked(Side::Right));
    world.inject(PlantFault::WheelBlocked(Side::Left));
    run(&mut world, Actuation::Release, 30.0);
    let there = world.truth().pose.x;
    run(&mut world, Actuation::Release, 30.0);
    assert!((world.truth().pose.x - there).abs() < 1.0e-9, "{there}");
}
