//! A base and short ways to drive it, shared by the tests of `world`.

use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist};
use sim_host::world::{Actuation, MotorParams, World, WorldKeys, WorldParams};

pub const TICK_US: u32 = 10_000;

/// 30 kg, 15 kg m², wheels of 0.1 m at 0.5 m.
pub fn robot() -> Robot<f64> {
    Robot::paper()
}

/// Wheels of 0.05 kg m² beside the body: as heavy as 5 kg each.
pub const WHEEL: f64 = 0.05;

pub fn perfect() -> WorldParams {
    let mut keys = WorldKeys::default();
    keys.body.wheel_inertia_kg_m2 = Some(WHEEL);
    keys.params(&robot())
}

/// K = 30 · 0.05 = 1.5 N m/A at each wheel, 0.5 Ω, 24 V behind 0.05 Ω.
pub fn motor() -> MotorParams {
    MotorParams {
        gear_ratio: 30.0,
        gear_efficiency: 1.0,
        kt_nm_per_a: 0.05,
        resistance_ohm: 0.5,
        inductance_h: 0.0,
        rotor_inertia_kg_m2: 0.0,
        current_limit_a: f64::INFINITY,
        dead_band: 0.0,
        strength: [1.0, 1.0],
    }
}

pub fn with_motor() -> WorldParams {
    let mut params = perfect();
    params.motor = Some(motor());
    params.battery.nominal_v = 24.0;
    params.battery.internal_ohm = 0.05;
    params
}

pub fn at_rest(params: &WorldParams) -> World {
    moving(params, 0.0, 0.0)
}

pub fn moving(params: &WorldParams, linear: f64, angular: f64) -> World {
    let start = Measured {
        pose: Pose::default(),
        twist: Twist::new(linear, angular),
    };
    World::new(params, &start, 1).expect("a plant")
}

pub fn run(world: &mut World, command: Actuation, seconds: f64) {
    for _ in 0..(seconds * 100.0).round() as usize {
        world.advance(&command, TICK_US).expect("a command");
    }
}

pub fn duty(share: f64) -> Actuation {
    Actuation::Duty {
        right: share,
        left: share,
    }
}

pub fn torque(right: f64, left: f64) -> Actuation {
    Actuation::Torque { right, left }
}

/// |found − expected| within a share of the expected.
#[track_caller]
pub fn near(found: f64, expected: f64, share: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= share * expected.abs(),
        "found {found}, expected {expected}: off by {:e} of it",
        error / expected.abs()
    );
}
