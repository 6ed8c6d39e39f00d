//! The realistic plant against the contract of the hardware traits, and as hardware of a whole loop.

use controller_core::hal::{Clock, ErrorKind, WheelDrive, WheelEncoders};
use controller_core::maths::Single;
use controller_core::motor::{Driver, MotorParams, WheelFriction, electrical_brake};
use controller_core::odometry::{Calibration, Odometry, OdometryParams};
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::Params;
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use sim_host::closed_loop::PlantHal;
use sim_host::world::{self, Actuation, World, WorldKeys};

/// Largest torque of either wheel \[N m\].
const LIMIT: f32 = 10.0;

fn plant(keys: &WorldKeys, start: &Measured<f64>) -> PlantHal {
    let world = World::new(&keys.params(&Robot::paper()), start, 1).expect("in order");
    PlantHal::new(world, &Driver::Torques, LIMIT)
}

fn both(torque: f32) -> WheelTorques<f32> {
    WheelTorques {
        right: torque,
        left: torque,
    }
}

fn acts(hal: &PlantHal, torque: f32) {
    let each = f64::from(torque);
    let expected = Actuation::Torque {
        right: each,
        left: each,
    };
    assert_eq!(*hal.actuation(), expected);
}

#[test]
fn the_plant_keeps_the_contract_of_a_drive() {
    let mut hal = plant(&WorldKeys::default(), &Measured::default());
    assert_eq!(hal.max_torque_nm(), LIMIT);
    hal.set_torques(both(0.5 * LIMIT)).expect("within");
    let above = f32::from_bits(LIMIT.to_bits() + 1);
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, above, -above] {
        for (right, left) in [(wrong, 0.0), (0.0, wrong), (wrong, wrong)] {
            let refused = hal.set_torques(WheelTorques { right, left });
            assert_eq!(refused, Err(ErrorKind::OutOfRange));
            acts(&hal, 0.5 * LIMIT);
        }
    }
    for torque in [LIMIT, -LIMIT, 0.0, -0.0] {
        hal.set_torques(both(torque)).expect("at the limit");
        acts(&hal, torque);
    }
    for _ in 0..2 {
        hal.release().expect("always");
        assert_eq!(*hal.actuation(), Actuation::Release);
    }
    hal.set_torques(both(LIMIT)).expect("after a release");
    acts(&hal, LIMIT);
    for _ in 0..2 {
        hal.brake().expect("always");
        assert_eq!(*hal.actuation(), Actuation::Brake);
    }
    hal.set_torques(both(LIMIT)).expect("after a brake");
    acts(&hal, LIMIT);
}

/// Against the core's braking distance, which is derived on its own: (g k_t)²/R of this motor is 1 N m s.
#[test]
fn braked_wheels_stop_where_the_core_says() {
    let motor: MotorParams<f64> = MotorParams {
        gear_ratio: 10.0,
        gear_efficiency: 1.0,
        torque_constant_nm_per_a: 0.2,
        resistance_ohm: 4.0,
        supply_v: 24.0,
        max_current_a: 5.0,
        friction: WheelFriction::NONE,
        dead_band: 0.0,
        rotor_inertia_kg_m2: 0.0,
    };
    let slowing = electrical_brake(&motor.validate().expect("in order"), &Robot::paper());
    let slowing = slowing.expect("in order");
    let keys = WorldKeys {
        motor: Some(world::MotorParams {
            gear_ratio: 10.0,
            gear_efficiency: 1.0,
            kt_nm_per_a: 0.2,
            resistance_ohm: 4.0,
            inductance_h: 0.0,
            rotor_inertia_kg_m2: 0.0,
            current_limit_a: f64::INFINITY,
            dead_band: 0.0,
            strength: [1.0; 2],
        }),
        ..WorldKeys::default()
    };
    let braked = |twist: Twist<f64>, seconds: u32| {
        let start = Measured {
            twist,
            ..Measured::default()
        };
        let mut hal = plant(&keys, &start);
        hal.brake().expect("always");
        for _ in 0..100 * seconds {
            hal.advance(10_000).expect("a command");
        }
        hal.world().truth().pose
    };
    // 0.15 s and 1.2 s of time constant: e^-20 of way and angle are left. The plant's wheels turn with a thousandth of
    // the mass each, and it takes a constant current in each substep of 0.25 ms: a share of 1e-3 for both.
    let way = slowing.linear.distance(0.8).expect("damped");
    let x = braked(Twist::new(0.8, 0.0), 3).x;
    assert!((x - way).abs() < 1.0e-3 * way, "{x} {way}");
    let angle = slowing.angular.distance(2.0).expect("damped");
    let turned = braked(Twist::new(0.0, 2.0), 24).theta;
    assert!((turned - angle).abs() < 1.0e-3 * angle, "{turned} {angle}");
}

/// Encoders to odometry to the paper's law to wheels, as on a board: no truth goes in.
#[test]
fn a_robot_that_knows_only_its_encoders_tracks_and_parks() {
    const PERIOD_US: u32 = 1000;
    let line = ConstantTwist {
        start: Pose::default(),
        twist: Twist::new(0.4_f32, 0.0),
    };
    let start = Pose::new(-0.3, 0.2, 0.3);
    let truth = Measured {
        pose: start,
        ..Measured::default()
    };
    let mut keys = WorldKeys::default();
    keys.encoder.counts_per_turn = 4096.0;
    let mut hal = plant(&keys, &truth);

    let params = Params {
        max_wheel_torque_nm: Some(hal.max_torque_nm()),
        ..Params::<f32>::paper()
    };
    let odometry = OdometryParams {
        wheels: params.robot.wheels,
        calibration: Calibration::NOMINAL,
        counts_per_turn: 4096.0,
        bandwidth: 200.0,
    };
    let pose = start.cast();
    let counts = hal.counts().expect("always");
    let mut odometry = Odometry::new(&odometry, pose, counts).expect("in order");
    let measured = Measured {
        pose,
        ..Measured::default()
    };
    let params = params.validate().expect("in order");
    let mut controller: NeuralController =
        NeuralController::start(&params, &line.at::<Single>(0.0), &measured).expect("starts");
    let goal = *line.at::<Single>(9.5).pose();
    let mut last_us = hal.now_us();
    for tick in 1..=20_000_u32 {
        hal.set_torques(controller.report().torques)
            .expect("within the limit");
        hal.advance(PERIOD_US).expect("a command");
        let now_us = hal.now_us();
        let dt = 1.0e-6 * now_us.wrapping_sub(last_us) as f32;
        last_us = now_us;
        let measured = odometry.update::<Single>(hal.counts().expect("always"), dt);
        let reference: Reference<f32> = line.at::<Single>(tick as f32 * 1.0e-3);
        let demand = match tick {
            ..9000 => Demand::Track(reference),
            9000 => Demand::HandOver { reference, goal },
            _ => Demand::Park,
        };
        controller.step(dt, &demand, &measured).expect("in order");
    }
    // The goal's frame is the world's.
    let parked = hal.world().truth().pose;
    let error = (parked.x - 3.8, parked.y, parked.theta);
    assert!(
        error.0.abs() < 0.005 && error.1.abs() < 0.01 && error.2.abs() < 0.01,
        "{error:?}"
    );
}
