//! The simulated base against the contract of the hardware traits, and as hardware of a whole loop.

use controller_core::error::{Field, Problem};
use controller_core::hal::{Clock, Error, ErrorKind, WheelCounts, WheelDrive, WheelEncoders};
use controller_core::maths::{Libm, Single};
use controller_core::motor::{MotorParams, WheelFriction, electrical_brake};
use controller_core::odometry::{Calibration, Odometry, OdometryParams};
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::Params;
use controller_core::pose_error::pose_error;
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use sim_host::sim_robot::{Equipment, SimRobot};

fn robot(start: &Measured<f64>, equipment: Equipment) -> SimRobot {
    SimRobot::new(Robot::paper(), start, equipment).expect("in order")
}

fn rolling(linear: f64, angular: f64) -> Measured<f64> {
    Measured {
        twist: Twist::new(linear, angular),
        ..Measured::default()
    }
}

fn both(torque: f32) -> WheelTorques<f32> {
    WheelTorques {
        right: torque,
        left: torque,
    }
}

/// What every drive must do, through the traits only.
fn keeps_the_contract(mut drive: impl WheelDrive, acting: impl Fn() -> WheelTorques<f32>) {
    let limit = drive.max_torque_nm();
    assert!(limit.is_finite() && limit > 0.0);
    drive.set_torques(both(0.5 * limit)).expect("within");
    let above = f32::from_bits(limit.to_bits() + 1);
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, above, -above] {
        for (right, left) in [(wrong, 0.0), (0.0, wrong), (wrong, wrong)] {
            let refused = drive.set_torques(WheelTorques { right, left });
            let kind = refused.expect_err("out of range").kind();
            assert_eq!(kind, ErrorKind::OutOfRange);
            assert_eq!(acting(), both(0.5 * limit), "wheels as they were");
        }
    }
    for torques in [limit, -limit, 0.0, -0.0] {
        drive.set_torques(both(torques)).expect("at the limit");
        assert_eq!(acting(), both(torques));
    }
    drive.set_torques(both(limit)).expect("at the limit");
    for _ in 0..2 {
        drive.release().expect("always");
        assert_eq!(acting(), both(0.0));
    }
    drive.set_torques(both(limit)).expect("after a release");
    assert_eq!(acting(), both(limit));
    for _ in 0..2 {
        drive.brake().expect("always");
        assert_eq!(acting(), both(0.0));
    }
    drive.set_torques(both(limit)).expect("after a brake");
    assert_eq!(acting(), both(limit));
}

#[test]
fn drive_keeps_the_contract() {
    let shared = robot(&Measured::default(), Equipment::default());
    let mut drive = shared.clone();
    keeps_the_contract(&mut drive, || shared.torques());
    keeps_the_contract(drive, || shared.torques());
}

#[test]
fn released_wheels_coast_and_torques_hold() {
    let shared = robot(&rolling(0.5, 0.0), Equipment::default());
    let mut drive = shared.clone();
    drive.release().expect("always");
    shared.advance(10_000);
    assert_eq!(shared.truth().twist.linear, 0.5);
    drive.set_torques(both(1.5)).expect("within");
    for _ in 0..1000 {
        shared.advance(1000);
    }
    // 2 * 1.5 N m on 0.1 m wheels push 30 kg with 30 N for 1 s.
    assert!((shared.truth().twist.linear - 1.5).abs() < 1.0e-12);
    assert_eq!(shared.truth().twist.angular, 0.0);
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
    };
    let motor = motor.validate().expect("in order");
    let slowing = electrical_brake(&motor, &Robot::paper()).expect("in order");
    let shared = robot(&rolling(0.8, 0.0), Equipment::default());
    let mut drive = shared.clone();
    drive.brake().expect("always");
    assert!(shared.braked());
    let constant = slowing.linear.time_constant_s().expect("damped");
    // 30 kg, 0.1 m, 2 * 1 N m s: 0.15 s.
    assert!((constant - 0.15).abs() < 1.0e-12);
    shared.advance(150_000);
    let speed = shared.truth().twist.linear;
    // Exact at the end of every substep, so rounding of 600 of them.
    assert!((speed - 0.8 * (-1.0_f64).exp()).abs() < 1.0e-12, "{speed}");
    shared.advance(3_000_000);
    let way = slowing.linear.distance(0.8).expect("damped");
    let truth = shared.truth();
    // The speed is taken as linear in time over 0.25 ms: (h/T)²/12 of the way, 3e-8 m.
    assert!((truth.pose.x - way).abs() < 1.0e-7, "{truth:?} {way}");

    let shared = robot(&rolling(0.0, 2.0), Equipment::default());
    shared.clone().brake().expect("always");
    // 1.2 s of time constant: e^-25 of the angle is left.
    shared.advance(30_000_000);
    let turned = shared.truth().pose.theta;
    let angle = slowing.angular.distance(2.0).expect("damped");
    assert!((turned - angle).abs() < 1.0e-5 * angle, "{turned} {angle}");
    shared.clone().release().expect("always");
    assert!(!shared.braked());
}

#[test]
fn encoders_count_whole_edges_forward_and_back() {
    let equipment = Equipment {
        counts_per_turn: 100.0,
        ..Equipment::default()
    };
    // A turn of a wheel is 0.2 pi m; at 0.2 pi m/s one per second.
    let turn = 0.2 * std::f64::consts::PI;
    for (speed, expected) in [(turn, [0, 9, 10, 95]), (-turn, [-1, -10, -11, -96])] {
        let mut robot = robot(&rolling(speed, 0.0), equipment);
        // 0.5, 9.5, 10.5, 95.5 counts of way.
        let mut counted = Vec::new();
        for us in [5_000, 90_000, 10_000, 850_000] {
            robot.advance(us);
            let counts = robot.counts().expect("always");
            assert_eq!(counts.right, counts.left);
            counted.push(counts.right);
        }
        assert_eq!(counted, expected);
    }
}

#[test]
fn wheels_are_told_apart() {
    let mut robot = robot(&rolling(0.0, 1.0), Equipment::default());
    robot.advance(100_000);
    let counts = robot.counts().expect("always");
    // Counter-clockwise: right forward, left backward; 0.025 m of 0.628 m a turn.
    assert_eq!((counts.right, counts.left), (162, -163));
}

#[test]
fn counts_and_clock_roll_over() {
    let equipment = Equipment {
        counts: WheelCounts {
            right: i32::MAX - 10,
            left: i32::MIN + 10,
        },
        now_us: u32::MAX - 499,
        ..Equipment::default()
    };
    let mut robot = robot(&rolling(0.0, 2.0), equipment);
    let before = robot.counts().expect("always");
    for _ in 0..100 {
        robot.advance(1000);
    }
    let after = robot.counts().expect("always");
    assert!(
        after.right < 0 && after.left > 0,
        "{before:?} to {after:?}: through both ends"
    );
    let moved = after.right.wrapping_sub(before.right);
    assert_eq!(moved, 325);
    assert_eq!(after.left.wrapping_sub(before.left), -326);
    assert_eq!(robot.now_us(), 100_000 - 500);
}

#[test]
fn equipment_out_of_range_is_refused() {
    let refused = |equipment| {
        SimRobot::new(Robot::paper(), &Measured::default(), equipment).expect_err("out of range")
    };
    for max_torque_nm in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let equipment = Equipment {
            max_torque_nm,
            ..Equipment::default()
        };
        assert_eq!(refused(equipment).field, Field::MaxWheelTorque);
    }
    for brake_nm_s in [0.0, f64::NAN, 1.0e7] {
        let equipment = Equipment {
            brake_nm_s,
            ..Equipment::default()
        };
        assert_eq!(refused(equipment).field, Field::BrakeDamping);
    }
    let equipment = Equipment {
        counts_per_turn: 0.5,
        ..Equipment::default()
    };
    let error = refused(equipment);
    assert_eq!(error.field, Field::CountsPerTurn);
    assert_eq!(error.problem, Problem::Below(1.0));
}

/// Encoders to odometry to controller to wheels, as on a board: no truth goes in.
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
    let shared = robot(&truth, Equipment::default());
    let (mut drive, mut encoders, clock) = (shared.clone(), shared.clone(), shared.clone());

    let params = Params {
        max_wheel_torque_nm: Some(drive.max_torque_nm()),
        ..Params::<f32>::paper()
    };
    let odometry = OdometryParams {
        wheels: params.robot.wheels,
        calibration: Calibration::NOMINAL,
        counts_per_turn: 4096.0,
        bandwidth: 200.0,
    };
    let pose = start.cast();
    let counts = encoders.counts().expect("always");
    let mut odometry = Odometry::new(&odometry, pose, counts).expect("in order");
    let measured = Measured {
        pose,
        ..Measured::default()
    };
    let params = params.validate().expect("in order");
    let mut controller: NeuralController =
        NeuralController::start(&params, &line.at::<Single>(0.0), &measured).expect("starts");
    let goal = *line.at::<Single>(9.5).pose();
    let mut last_us = clock.now_us();
    for tick in 1..=20_000_u32 {
        drive
            .set_torques(controller.report().torques)
            .expect("within the limit");
        shared.advance(PERIOD_US);
        let now_us = clock.now_us();
        let dt = 1.0e-6 * now_us.wrapping_sub(last_us) as f32;
        last_us = now_us;
        let measured = odometry.update::<Single>(encoders.counts().expect("always"), dt);
        let reference = line.at::<Single>(tick as f32 * 1.0e-3);
        let demand = match tick {
            ..9000 => Demand::Track(reference),
            9000 => Demand::HandOver { reference, goal },
            _ => Demand::Park,
        };
        controller.step(dt, &demand, &measured).expect("in order");
    }
    let target = Reference::at_rest_with::<Libm>(Pose::new(3.8, 0.0, 0.0));
    let error = pose_error::<f64, Libm>(target.pose(), &shared.truth().pose);
    assert!(
        error.x.abs() < 0.005 && error.y.abs() < 0.01 && error.theta.abs() < 0.01,
        "{error:?}"
    );
}
