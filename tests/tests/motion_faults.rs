//! Refused ticks change nothing; refused parameters name field and limit.

use controller_core::error::{Field, Input, ParamError, Problem, StepFault};
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{JumpThreshold, MotionController, MotionParams, Outcome, Task};
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Accel, Measured, Pose, Twist, Wrench};
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, home};

/// Three poses, three twists and a tick, with one number replaced.
fn inputs<T: Scalar, M: Maths<T>>(place: usize, wrong: f64) -> (Task<T>, Task<T>, Measured<T>) {
    let mut values = [0.3, 0.2, 0.1, 0.4, 0.1, 0.2, 0.3, 0.1, -0.1, 0.2, 0.3, 0.1];
    values[place] = wrong;
    let f = |i: usize| T::from_f64(values[i]);
    let pose = Pose::new(f(0), f(1), f(2));
    let (twist, accel) = (Twist::new(f(3), f(4)), Accel::new(f(5), f(6)));
    let measured = Measured {
        pose: Pose::new(f(7), f(8), f(9)),
        twist: Twist::new(f(10), f(11)),
    };
    let follow = Task::Follow(Reference::new_with::<M>(pose, twist, accel));
    (follow, Task::Park(pose), measured)
}

fn faults_change_nothing<T, M, U>()
where
    T: Scalar,
    M: Maths<T> + PartialEq,
    U: NeuronUpdate<T> + PartialEq,
{
    let motion = Base::STANDARD.params::<T, M>().validate().expect("valid");
    let (follow, park, good) = inputs::<T, M>(0, 0.3);
    let dt = T::from_f64(0.01);
    let start = MotionController::<T, M, U>::start;
    let mut controller = start(&motion, &follow, &good).expect("finite");
    controller.step(dt, &park, &good).expect("finite");
    let before = controller;
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..12 {
            let (follow, park, measured) = inputs::<T, M>(place, wrong);
            let (following, parking) = match place {
                0..3 => (Some(Input::Reference), Some(Input::Goal)),
                3..7 => (Some(Input::Reference), None),
                7..10 => (Some(Input::Pose), Some(Input::Pose)),
                _ => (Some(Input::Twist), Some(Input::Twist)),
            };
            for (task, input) in [(follow, following), (park, parking)] {
                let Some(input) = input else { continue };
                let fault = StepFault::NotFinite(input);
                assert_eq!(controller.step(dt, &task, &measured), Err(fault));
                assert_eq!(start(&motion, &task, &measured), Err(fault));
                assert_eq!(controller, before);
            }
        }
    }
    for (dt, fault) in [
        (0.0, StepFault::TickNotPositive),
        (-0.01, StepFault::TickNotPositive),
        (f64::NAN, StepFault::NotFinite(Input::Tick)),
        (
            0.6,
            StepFault::TickTooLong {
                max_tick_us: 500_000,
            },
        ),
    ] {
        let answer = controller.step(T::from_f64(dt), &park, &good);
        assert_eq!(answer, Err(fault), "tick of {dt} s");
        assert_eq!(controller, before);
    }
    let (_, park, mut measured) = inputs::<T, M>(0, T::MAX.to_f64());
    measured.pose.x = -T::MAX;
    assert_eq!(
        controller.step(dt, &park, &measured),
        Err(StepFault::Overflow)
    );
    assert_eq!(controller, before);
    // And on it goes.
    controller.step(dt, &follow, &good).expect("finite");
}

#[test]
fn refused_ticks_change_nothing_in_double_precision() {
    faults_change_nothing::<f64, Libm, ExactMean>();
}

#[test]
fn refused_ticks_change_nothing_in_single_precision() {
    faults_change_nothing::<f32, Single, RationalMean>();
}

/// A tick with a speed that asks for no torque there is, refused at every instant of a manoeuvre: while one is searched for, on
/// the way, where a stretch of its jerk ends, beside its goal, at rest.
fn manoeuvres_are_kept<T, M, U>()
where
    T: Scalar,
    M: Maths<T> + PartialEq,
    U: NeuronUpdate<T> + PartialEq,
{
    let base = Base::STANDARD;
    let motion = base.params::<T, M>().validate().expect("valid");
    let order = home()(0.0);
    let goal = Task::Park(Pose::default());
    let dt = 0.01;
    for start in [
        Body::at(-1.5, 0.7, 0.4),
        Body::at(0.6, -0.3, 2.0),
        Body::at(0.0, 0.02, 0.0),
        Body {
            twist: Twist::new(0.8, 0.3),
            ..Body::at(-0.6, 0.05, -0.1)
        },
    ] {
        let mut drive = Drive::<T, M, U>::start(&motion, base, start, &order, dt);
        for _ in 0..1000 {
            drive.coast(&Wrench::default());
            let measured = drive.body.measured();
            let mut wild = measured;
            wild.twist.linear = T::MAX;
            let before = drive.controller;
            let answer = drive.controller.step(T::from_f64(dt), &goal, &wild);
            assert_eq!(answer, Err(StepFault::Overflow), "{:?}", drive.body);
            assert!(drive.controller == before, "{:?}", drive.body);
            drive.take(&order, &measured);
        }
        assert_eq!(drive.report().outcome, Outcome::Parked, "{start:?}");
    }
}

#[test]
fn ticks_refused_on_a_manoeuvre_change_nothing() {
    manoeuvres_are_kept::<f64, Libm, ExactMean>();
    manoeuvres_are_kept::<f32, Single, RationalMean>();
}

type Place = fn(&mut MotionParams<f64>) -> &mut f64;

/// Every field with its range.
const FIELDS: [(Field, Place, f64, f64); 33] = [
    (Field::Mass, |p| &mut p.robot.mass_kg, 1e-3, 1e5),
    (Field::Inertia, |p| &mut p.robot.inertia_kg_m2, 1e-6, 1e6),
    (
        Field::RadiusRight,
        |p| &mut p.robot.wheels.radius_right_m,
        0.0,
        0.0,
    ),
    (
        Field::RadiusLeft,
        |p| &mut p.robot.wheels.radius_left_m,
        0.0,
        0.0,
    ),
    (Field::Track, |p| &mut p.robot.wheels.track_m, 0.0, 0.0),
    (Field::MaxSpeed, |p| &mut p.limits.speed, 1e-3, 100.0),
    (Field::MaxTurnRate, |p| &mut p.limits.turn_rate, 1e-3, 100.0),
    (Field::MaxRimSpeed, |p| &mut p.limits.rim_speed, 1e-3, 1e3),
    (Field::MaxAccel, |p| &mut p.limits.accel, 1e-3, 1e3),
    (Field::MaxBrake, |p| &mut p.limits.brake, 1e-3, 1e3),
    (Field::MaxTurnAccel, |p| &mut p.limits.turn_accel, 1e-3, 1e4),
    (Field::MaxJerk, |p| &mut p.limits.jerk, 1e-2, 1e6),
    (Field::MaxTurnJerk, |p| &mut p.limits.turn_jerk, 1e-2, 1e6),
    (
        Field::MaxWheelTorque,
        |p| &mut p.limits.wheel_torque_nm,
        1e-6,
        1e6,
    ),
    (Field::DecayA, |p| &mut p.gains.decay, 0.1, 100.0),
    (Field::K1, |p| &mut p.gains.longitudinal, 1e-3, 100.0),
    (
        Field::LongitudinalBound,
        |p| &mut p.gains.longitudinal_bound,
        1e-3,
        100.0,
    ),
    (Field::K3, |p| &mut p.gains.heading, 1e-3, 100.0),
    (Field::K2, |p| &mut p.gains.lateral, 1e-3, 100.0),
    (Field::SlowSpeed, |p| &mut p.gains.slow, 1e-4, 10.0),
    (Field::K4, |p| &mut p.gains.approach, 1e-3, 100.0),
    (
        Field::ApproachBrake,
        |p| &mut p.gains.approach_brake,
        1e-4,
        1e3,
    ),
    (Field::SpeedLoop, |p| &mut p.gains.speed_loop, 0.1, 1e3),
    (Field::TurnLoop, |p| &mut p.gains.turn_loop, 0.1, 1e3),
    (Field::PoseNoise, |p| &mut p.pose_noise_m, 0.0, 1.0),
    (
        Field::ArrivalDistance,
        |p| &mut p.arrival.distance_m,
        1e-5,
        10.0,
    ),
    (
        Field::ArrivalHeading,
        |p| &mut p.arrival.heading_rad,
        1e-5,
        3.0,
    ),
    (Field::ArrivalDwell, |p| &mut p.arrival.dwell_s, 0.0, 10.0),
    (
        Field::StallSpeed,
        |p| &mut p.arrival.stall_speed,
        1e-4,
        10.0,
    ),
    (Field::StallTime, |p| &mut p.arrival.stall_s, 1e-2, 1e3),
    (
        Field::JumpDistance,
        |p| &mut threshold(p).distance_m,
        1e-4,
        100.0,
    ),
    (
        Field::JumpHeading,
        |p| &mut threshold(p).heading_rad,
        1e-4,
        4.0,
    ),
    (Field::MaxTick, |p| &mut p.max_tick_s, 1e-6, 1e3),
];

fn threshold(params: &mut MotionParams<f64>) -> &mut JumpThreshold<f64> {
    params.jump.get_or_insert(JumpThreshold {
        distance_m: 0.1,
        heading_rad: 0.1,
    })
}

/// NaN, just below and just above: the field is named, and the limit; its ends are accepted.
#[test]
fn refused_parameters_name_field_and_limit() {
    for (field, place, low, high) in FIELDS {
        let refusal = |value: f64| {
            let mut params = Base::STANDARD.exact();
            *place(&mut params) = value;
            params.validate().err()
        };
        let problem = Problem::NotFinite;
        assert_eq!(refusal(f64::NAN), Some(ParamError { field, problem }));
        if high == 0.0 {
            // Geometry has ranges of its own, tested with the wheels.
            assert_eq!(refusal(-1.0).map(|error| error.field), Some(field));
            continue;
        }
        let problem = Problem::Below(low);
        let below = if low > 0.0 { 0.999 * low } else { -1e-9 };
        assert_eq!(refusal(below), Some(ParamError { field, problem }));
        let problem = Problem::Above(high);
        assert_eq!(refusal(1.001 * high), Some(ParamError { field, problem }));
        assert_eq!(refusal(low), None, "{field:?}");
        assert_eq!(refusal(high), None, "{field:?}");
    }
}

/// A robot that moves too fast already: the command is the limit, of both axes and of the rim that both share; the torque brakes.
#[test]
fn start_beyond_the_limits_brakes() {
    let motion = Base::STANDARD.exact().validate().expect("valid");
    let body = Body {
        twist: Twist::new(5.0, -6.0),
        ..Body::default()
    };
    let task = Task::Park(Pose::default());
    let started = MotionController::<f64, Libm, ExactMean>::start(&motion, &task, &body.measured());
    let report = *started.expect("finite").report();
    // 2.5 m/s and 3 rad/s on a track of 0.5 m would be 3.25 m/s at a rim that may have 2.5.
    let share = 2.5 / (2.5 + 0.25 * 3.0);
    assert_eq!(report.command, Twist::new(share * 2.5, share * -3.0));
    assert!(report.wrench.force < 0.0 && report.wrench.moment > 0.0);
}
