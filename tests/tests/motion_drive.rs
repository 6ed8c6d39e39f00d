//! Driving by velocity: orders of any size at any tick, exact in the end, the heading held.

use controller_core::angle::wrap;
use controller_core::error::{Input, StepFault};
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{
    Mode, MotionController, SaturationPolicy, Task, ValidMotionParams, check_goal, check_order,
};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Accel, Pose, Twist, WheelTorques, Wrench};
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body, pose};
use tests::motion_loop::{Drive, Order};
use tests::random::Random;
use tests::stated::{At, Stated};
use tests::tolerance::{MOTION_LIMIT, MOTION_RATE};

type Exact = Drive<f64, Libm, ExactMean>;

const BASES: [(&str, Base); 3] = [
    ("standard", Base::STANDARD),
    ("weak", Base::WEAK),
    ("small", Base::SMALL),
];

fn drive(v: f64, w: f64, hold_heading: bool) -> Order {
    Task::Drive {
        twist: Twist::new(v, w),
        hold_heading,
    }
}

fn start(base: Base, body: Body, order: &Order) -> Exact {
    let motion = base.exact().validate().expect("valid");
    Drive::start(&motion, base, body, order, 0.01)
}

/// What random orders came to, in shares of L.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    force: f64,
    moment: f64,
    /// Of twice L, in the norm of the harder worked wheel, while wheels are at their limit.
    saturated: f64,
    orders: u32,
}

/// Ticks of a run.
const TICKS: u32 = 100_000;

/// A new velocity order: within the limits, far beyond them, none, or opposite; sometimes another kind of task.
fn any_order(random: &mut Random, body: &Body) -> Order {
    let size = match (random.within(1.0) + 1.0) * 2.0 {
        0.0..0.4 => 0.0,
        0.4..1.2 => 0.1,
        1.2..3.0 => 3.0,
        _ => 100.0,
    };
    let (v, w) = (random.within(size), random.within(size));
    let aside = Pose::new(
        body.pose.x + random.within(1.0),
        body.pose.y + random.within(1.0),
        body.pose.theta + random.within(1.0),
    );
    match random.within(1.0) {
        0.9..1.0 => Task::Park(aside),
        0.8..0.9 => Task::Follow(Reference::new_with::<Libm>(
            aside,
            Twist::new(v.clamp(-1.5, 1.5), w.clamp(-1.0, 1.0)),
            Accel::default(),
        )),
        _ => drive(v, w, random.within(1.0) < 0.0),
    }
}

/// Orders at random ticks, every `often`-th on average, and jumps of the localisation.
fn random_orders<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    base: Base,
    dt: f64,
    often: f64,
) -> Shares {
    let motion: ValidMotionParams<T> = base.params::<T, M>().validate().expect("valid");
    let limits = motion.params().limits;
    let (l_f, l_n) = (
        motion.force_rate_limit().to_f64() * dt,
        motion.moment_rate_limit().to_f64() * dt,
    );
    let both = 2.0 * Base::wheel_norm(l_f, l_n);
    let mut random = Random(0xD417_0001);
    let mut order = drive(0.0, 0.0, false);
    let mut drive = Drive::<T, M, U>::start(&motion, base, Body::default(), &order, dt);
    let mut offset = Pose::default();
    let mut seen = Shares::default();
    let (mut last, mut was_saturated) = (drive.applied(), false);
    for _ in 0..TICKS {
        drive.coast(&Wrench::default());
        if random.within(1.0) < 2.0 / often - 1.0 {
            order = any_order(&mut random, &drive.body);
            seen.orders += 1;
        }
        if random.within(1.0) < -0.995 {
            offset = Pose::new(random.within(0.3), random.within(0.3), random.within(1.0));
            drive.controller.declare_jump();
        }
        let mut measured = drive.body.measured::<T>();
        let at = &drive.body.pose;
        measured.pose = pose(&Pose::new(
            at.x + offset.x,
            at.y + offset.y,
            at.theta + offset.theta,
        ));
        let report = drive.take(&order, &measured);
        let saturated = report.limited.torque;
        let command = report.command;
        assert!(command.linear.abs() <= limits.speed && command.angular.abs() <= limits.turn_rate);
        if let Task::Drive { twist, .. } = &order {
            let beyond = twist.linear.abs() > limits.speed.to_f64()
                || twist.angular.abs() > limits.turn_rate.to_f64();
            assert!(report.mode == Mode::Driving && (report.limited.speed || !beyond));
        }
        let applied = drive.applied();
        let (f, n) = (applied.force - last.force, applied.moment - last.moment);
        if saturated || was_saturated {
            seen.saturated = seen.saturated.max(Base::wheel_norm(f, n) / both);
        } else {
            seen.force = seen.force.max(f.abs() / l_f);
            seen.moment = seen.moment.max(n.abs() / l_n);
        }
        (last, was_saturated) = (applied, saturated);
    }
    seen
}

/// Orders of any size that change seldom, often and in every tick, with and without a heading to hold, between other
/// tasks and jumps of the localisation: in both precisions, at 10 and 1 ms, on wheels that saturate too.
#[test]
fn orders_of_any_size_change_the_wrench_by_at_most_l_dt() {
    let tight = Base {
        limits: controller_core::motion::Limits {
            wheel_torque_nm: 4.0,
            ..Base::STANDARD.limits
        },
        ..Base::STANDARD
    };
    let bases = [
        BASES[0],
        BASES[1],
        BASES[2],
        ("keep curvature", tight),
        ("turn first", tight.with_policy(SaturationPolicy::TurnFirst)),
        (
            "drive first",
            tight.with_policy(SaturationPolicy::DriveFirst),
        ),
    ];
    let mut cases = Vec::new();
    for base in bases {
        for dt in [0.01, 0.001] {
            for often in [1.0, 10.0, 200.0] {
                cases.push((base, dt, often));
            }
        }
    }
    let runs = on_all_cores(&cases, |((_, base), dt, often)| {
        (
            random_orders::<f64, Libm, ExactMean>(*base, *dt, *often),
            random_orders::<f32, Single, RationalMean>(*base, *dt, *often),
        )
    });
    let (mut most, mut saturated) = (0.0_f64, 0.0_f64);
    for (((name, _), dt, often), (double, single)) in cases.iter().zip(runs) {
        println!("{name}, {dt} s, one order in {often} ticks: {double:.3?} {single:.3?}");
        for (run, slack) in [(double, MOTION_RATE.0), (single, MOTION_RATE.1)] {
            assert!(run.orders > 400);
            assert!(run.force <= 1.0 + slack, "{name}: {run:?}");
            assert!(run.moment <= 1.0 + slack, "{name}: {run:?}");
            assert!(run.saturated <= 1.0 + slack, "{name}: {run:?}");
            most = most.max(run.force).max(run.moment);
            saturated = saturated.max(run.saturated);
        }
    }
    Stated::of("docs/motion.md").exactly(
        At::Phrase("Velocity orders of any size, for # million ticks at 10 and 1 ms in both precisions: a step of at most # of L dt, and # of twice that"),
        &[cases.len() as f64 * f64::from(TICKS) / 1e6, most, saturated],
    );
}

/// Steps from rest to an order, to another and back to rest: within the limits the command does not overshoot, but for the heading that a
/// ramp's beginning loses, where what is fed forward is limited in its jerk, and that its end has half forgotten: 0.8 % of the largest turn rate
/// at most. In the end the robot has the ordered twist to the last digits.
#[test]
fn the_ideal_robot_drives_exactly_as_ordered() {
    for (name, base) in BASES {
        let limits = base.limits;
        let orders = [
            (0.3, 0.2),
            (-0.5, 0.4),
            (0.02, 0.0),
            (0.0, -0.05),
            (0.0, 0.0),
        ]
        .map(|(v, w)| (v * limits.speed, w * limits.turn_rate));
        let mut robot = start(base, Body::default(), &drive(0.0, 0.0, false));
        for (v, w) in orders {
            let from = robot.report().command;
            let (low, high) = (from.linear.min(v), from.linear.max(v));
            let (slow, fast) = (from.angular.min(w), from.angular.max(w));
            // The limits take so long, and the lag the rest.
            let ramp = (v - from.linear).abs() / limits.accel.min(limits.brake)
                + (w - from.angular).abs() / limits.turn_accel;
            for _ in 0..(100.0 * (ramp + 6.0)) as u32 {
                let command = robot.advance(|_| drive(v, w, false)).command;
                let slack = MOTION_LIMIT * limits.speed;
                assert!(
                    command.linear >= low - slack && command.linear <= high + slack,
                    "{name} {v} {command:?}"
                );
                let slack = 0.8e-2 * limits.turn_rate;
                assert!(
                    command.angular >= slow - slack && command.angular <= fast + slack,
                    "{name} {w} {command:?}"
                );
            }
            let twist = robot.body.twist;
            assert!((twist.linear - v).abs() < 1e-6, "{name}: {twist:?} for {v}");
            assert!(
                (twist.angular - w).abs() < 1e-6,
                "{name}: {twist:?} for {w}"
            );
        }
    }
}

/// A stick that moves: 20 orders a second of a sine, and one in every tick. The command is late by two lags of 1/A, A = e j/a, and by
/// no more for orders that come in every tick; on both axes, by the one that has less jerk for its acceleration.
#[test]
fn orders_that_change_all_the_time_are_followed() {
    let of = |jerk: f64, turn_jerk: f64| Base {
        limits: controller_core::motion::Limits {
            jerk,
            turn_jerk,
            ..Base::STANDARD.limits
        },
        ..Base::STANDARD
    };
    // The acceleration is 1.5 m/s² and 3 rad/s².
    for (base, every, per_s) in [
        (Base::STANDARD, 1, 20.0 / 1.5),
        (Base::STANDARD, 5, 20.0 / 1.5),
        (of(10.0, 40.0), 1, 10.0 / 1.5),
        (of(20.0, 20.0), 1, 20.0 / 3.0),
    ] {
        let lag = 1.0 / (core::f64::consts::E * per_s);
        let stick = |t: f64| drive(0.3 * (0.5 * t).sin(), 0.3 * (0.7 * t).cos(), false);
        let mut robot = start(base, Body::default(), &stick(0.0));
        for tick in 0..4000_u32 {
            let of = f64::from(tick / every * every) * 0.01;
            robot.advance(|_| stick(of));
            if tick < 300 {
                continue;
            }
            let late = robot.t - 2.0 * lag - 0.005 * f64::from(every - 1);
            let Task::Drive { twist, .. } = stick(late) else {
                unreachable!()
            };
            // Two ticks of it, at 0.15 m/s² and 0.21 rad/s².
            assert!((robot.body.twist.linear - twist.linear).abs() < 3.0e-3);
            assert!((robot.body.twist.angular - twist.angular).abs() < 4.2e-3);
        }
    }
}

/// From rest to nine tenths of a small step, which no limit of acceleration slows. Not sooner than the jerk alone lets it, √(2 · 0.045/j),
/// 67 ms at 20 m/s³; and not later than the lag, 3.9/A, 108 ms at A = e · 20/1.5, begun as much later as the jerk alone takes:
/// 175 ms, of which 170 are asked.
#[test]
fn a_small_order_is_obeyed_at_once() {
    for (name, base) in [BASES[0], BASES[2]] {
        let order = drive(0.05, 0.05, false);
        let mut robot = start(base, Body::default(), &order);
        while robot.body.twist.linear < 0.045 || robot.body.twist.angular < 0.045 {
            robot.advance(|_| order);
            assert!(robot.t < 0.17, "{name}: {:?}", robot.body.twist);
        }
        let least = (2.0 * 0.045 / base.limits.jerk).sqrt();
        assert!(robot.t > least, "{name}: not within its limits");
    }
}

/// What is no goal is a typed error, by whoever asks before it is one.
#[test]
fn goals_are_finite_and_not_beyond_two_kilometres() {
    for (wrong, fault) in [
        (f32::NAN, StepFault::NotFinite(Input::Goal)),
        (f32::NEG_INFINITY, StepFault::NotFinite(Input::Goal)),
        // Single precision tells places 0.12 mm apart at two kilometres.
        (2001.0, StepFault::OutOfRange(Input::Goal)),
        (-1e30, StepFault::OutOfRange(Input::Goal)),
    ] {
        assert_eq!(check_goal(&Pose::new(wrong, 0.0, 0.0)), Err(fault));
        assert_eq!(check_goal(&Pose::new(0.0, wrong, 0.0)), Err(fault));
    }
    assert_eq!(check_goal(&Pose::new(2000.0_f32, -2000.0, 90.0)), Ok(()));
    let turned = check_goal(&Pose::new(0.0_f32, 0.0, 1.1e5));
    assert_eq!(turned, Err(StepFault::OutOfRange(Input::Goal)));
}

/// What is no order is a typed error and changes nothing; what is beyond the limits is driven at the limits, and said.
#[test]
fn orders_are_refused_typed_and_limited_orders_said() {
    let mut robot = start(Base::STANDARD, Body::default(), &drive(0.3, 0.1, true));
    robot.advance(|_| drive(0.3, 0.1, true));
    let before = robot.controller;
    let motion = *before.motion();
    let measured = robot.body.measured();
    for (wrong, fault) in [
        (f64::NAN, StepFault::NotFinite(Input::Order)),
        (f64::INFINITY, StepFault::NotFinite(Input::Order)),
        (100.1, StepFault::OutOfRange(Input::Order)),
        (-1e300, StepFault::OutOfRange(Input::Order)),
    ] {
        for (v, w) in [(wrong, 0.0), (0.0, wrong)] {
            let order = drive(v, w, true);
            assert_eq!(check_order(&Twist::new(v, w)), Err(fault));
            assert_eq!(robot.controller.step(0.01, &order, &measured), Err(fault));
            assert_eq!(robot.controller, before);
            let started =
                MotionController::<f64, Libm, ExactMean>::start(&motion, &order, &measured);
            assert_eq!(started, Err(fault));
        }
    }
    // A speed and torques that nothing has: the next tick would not be finite, and the law would remember it.
    for wrong in [1e10, 1e38, -1e300] {
        for (linear, angular) in [(wrong, 0.0), (0.0, wrong)] {
            let mut wild = measured;
            wild.twist = Twist::new(linear, angular);
            let order = drive(0.3, 0.1, true);
            let refused = robot.controller.step(0.01, &order, &wild).map(|_| ());
            assert_eq!(refused, Err(StepFault::Overflow));
            let (right, left) = (linear, angular);
            let noted = robot.controller.note_applied(&WheelTorques { right, left });
            assert_eq!(noted, Err(StepFault::OutOfRange(Input::Applied)));
            assert_eq!(robot.controller, before);
        }
    }
    // Nor has a wheel more than ten times what the robot's have, in whatever unit it is told.
    let ten = 10.0 * robot.controller.motion().params().limits.wheel_torque_nm;
    for (right, left) in [(1.001 * ten, 0.0), (0.0, -1.001 * ten)] {
        let noted = robot.controller.note_applied(&WheelTorques { right, left });
        assert_eq!(noted, Err(StepFault::OutOfRange(Input::Applied)));
        assert_eq!(robot.controller, before);
    }
    let mut noting = robot.controller;
    let (right, left) = (ten, -ten);
    let noted = noting.note_applied(&WheelTorques { right, left });
    assert_eq!(noted, Ok(()));
    // Alone each goes to its limit; both together to what turns no wheel faster than 2.5 m/s at its rim, along the same arc.
    for ((v, w), (to, turn)) in [
        ((100.0, 0.0), (2.5, 0.0)),
        ((-2.6, 0.0), (-2.5, 0.0)),
        ((0.0, 3.1), (0.0, 3.0)),
        ((2.5, -3.0), (2.5 * 2.5 / 3.25, -3.0 * 2.5 / 3.25)),
        ((50.0, -100.0), (2.5 * 2.5 / 3.25, -3.0 * 2.5 / 3.25)),
    ] {
        for _ in 0..1200 {
            let report = robot.advance(|_| drive(v, w, false));
            assert!(report.limited.speed, "{v} {w}");
        }
        let twist = robot.body.twist;
        assert!((twist.linear - to).abs() < 1e-6, "{v}: {twist:?}");
        assert!((twist.angular - turn).abs() < 1e-6, "{w}: {twist:?}");
    }
    // A heading that is remembered may be wrong by rounding, and asks for so much more.
    for (v, w) in [(2.499, 0.0), (0.0, -2.999), (1.749, 2.999)] {
        // On the way there the accelerations may need a rim that is faster than it may be.
        for _ in 0..400 {
            robot.advance(|_| drive(v, w, false));
        }
        let report = robot.advance(|_| drive(v, w, false));
        assert!(!report.limited.speed, "{v} {w}");
    }
}

/// A moment of a tenth of the largest comes and goes while the robot drives straight on, and along an arc.
#[test]
fn the_heading_is_held_against_pushes() {
    for (name, base) in BASES {
        let most = base.limits.wheel_torque_nm / base.radius * base.track;
        let push = Wrench {
            force: 0.0,
            moment: 0.1 * most,
        };
        let w = 0.2 * base.limits.turn_rate;
        // The third is slower than what counts as standing.
        for order in [(0.3, 0.0), (-0.3, 0.0), (5e-3, 0.0), (0.3, w), (0.0, w)] {
            let off = |hold: bool| {
                let order = drive(order.0, order.1, hold);
                let mut robot = start(base, Body::default(), &order);
                let mut peak = 0.0_f64;
                for tick in 0..2000 {
                    let pushed = (500..1000).contains(&tick);
                    robot.coast(&if pushed { push } else { Wrench::default() });
                    let measured = robot.body.measured();
                    let report = robot.take(&order, &measured);
                    peak = peak.max(report.error.theta.abs());
                }
                (robot.body.pose.theta, peak, robot.report().error.theta)
            };
            let (free, _, forgotten) = off(false);
            let (held, peak, error) = off(true);
            // T = 0.4 s, for ten seconds since the push: e^-25.
            assert!(forgotten.abs() < 1e-9, "{name}: {forgotten}");
            // Undisturbed the arc turns by w t less the lag, w 2/12 s.
            let lag = 2.0 / 12.0;
            let meant = order.1 * (20.0 - lag);
            println!(
                "{name} {order:?}: {:.4} rad off, held {:.5}, peak {peak:.4}",
                free - meant,
                held - meant
            );
            assert!(error.abs() < 1e-3, "{name}: {error}");
            assert!(peak > 1e-3 && peak < 0.5, "{name}: {peak}");
            // The start of a weak base is limited, and takes its share of the arc.
            if order.1 == 0.0 {
                assert!((held - meant).abs() < 1e-3, "{name}: {held}");
            }
        }
    }
}

/// Wheels of unlike radii, believed alike, turn a robot that is ordered to drive straight on; with the heading held it goes straight. One that is
/// remembered for T = 0.4 s leaves (1 + k₃/κ)/(1 + k₃ T) of the 0.01 rad/s that odometry does not see: κ, since the rate that is fed forward
/// believes it.
#[test]
fn the_heading_is_held_on_unlike_wheels() {
    let base = Base::STANDARD;
    let run = |hold: bool| {
        let order = drive(0.5, 0.0, hold);
        let mut robot = start(base, Body::default(), &order);
        for _ in 0..2000 {
            robot.coast(&Wrench::default());
            let mut measured = robot.body.measured::<f64>();
            // The right wheel is 1 % larger: encoders report less turning than there is.
            measured.twist.angular -= 0.01 * measured.twist.linear / base.track;
            robot.take(&order, &measured);
        }
        robot.body.pose.theta
    };
    let (free, held) = (run(false), run(true));
    println!("after 20 s {free:.3} rad, held {held:.4}");
    let gains = base.exact().gains;
    let left = (1.0 + gains.heading / gains.turn_loop) / (1.0 + 0.4 * gains.heading);
    assert!((free / (20.0 * 0.01 * left) - 1.0).abs() < 0.02, "{free}");
    assert!(held.abs() < 0.01, "{held}");
}

/// A jump of the map is none of the robot: it goes on straight, in the direction that it had. So with a threshold for jumps that
/// nobody declares.
#[test]
fn a_jump_of_the_localisation_turns_nothing() {
    for declared in [true, false] {
        let mut params = Base::STANDARD.exact();
        if !declared {
            params.jump = Some(controller_core::motion::JumpThreshold {
                distance_m: 0.05,
                heading_rad: 0.05,
            });
        }
        let motion = params.validate().expect("valid");
        let order = drive(0.5, 0.0, true);
        let mut robot = Exact::start(&motion, Base::STANDARD, Body::default(), &order, 0.01);
        for tick in 0..1000 {
            robot.coast(&Wrench::default());
            let mut measured = robot.body.measured::<f64>();
            if tick >= 500 {
                measured.pose.theta = wrap(measured.pose.theta + 2.0);
            }
            if tick == 500 && declared {
                robot.controller.declare_jump();
            }
            let report = robot.take(&order, &measured);
            assert_eq!(
                report.jumped,
                tick == 500 || (!declared && tick == 501),
                "{tick}"
            );
            assert!(
                robot.body.pose.theta.abs() < 1e-9,
                "{tick}: {:?}",
                robot.body.pose
            );
        }
    }
}

/// Ordered to stand, a robot holds its heading until it does: straight on, and where it turns in place.
#[test]
fn the_heading_is_held_until_it_stands() {
    let push = Wrench {
        force: 0.0,
        moment: 5.0,
    };
    for (v, w) in [(0.5, 0.0), (0.0, 0.6)] {
        let mut robot = start(Base::STANDARD, Body::default(), &drive(v, w, true));
        for tick in 0..700 {
            let pushed = (450..500).contains(&tick);
            robot.coast(&if pushed { push } else { Wrench::default() });
            let order = if tick < 500 {
                drive(v, w, true)
            } else {
                drive(0.0, 0.0, true)
            };
            let measured = robot.body.measured::<f64>();
            let error = robot.take(&order, &measured).error.theta.abs();
            // 0.5 m/s and 0.6 rad/s take 0.33 and 0.2 s to brake, and the lag of 1/36 s little more.
            match tick {
                500..515 => assert!(error > 1e-4, "{v} {w} {tick}: {error}"),
                600.. => assert!(error == 0.0, "{v} {w} {tick}: {error}"),
                _ => (),
            }
        }
    }
}

/// A robot that is ordered to stand holds no heading, whatever the pose says; ordered to drive, it takes the heading that it has.
#[test]
fn a_robot_at_rest_does_not_turn_for_its_heading() {
    let mut robot = start(Base::STANDARD, Body::default(), &drive(0.3, 0.0, true));
    let mut noise = Random(7);
    for tick in 0..1500 {
        robot.coast(&Wrench::default());
        let mut measured = robot.body.measured::<f64>();
        measured.pose.theta += noise.within(0.01);
        let order = if (500..1000).contains(&tick) {
            drive(0.0, 0.0, true)
        } else {
            drive(0.3, 0.0, true)
        };
        let report = robot.take(&order, &measured);
        if (700..1000).contains(&tick) {
            assert!(
                report.error.theta == 0.0 && report.wrench.moment.abs() < 1e-3,
                "{tick}"
            );
        }
        if tick == 1000 {
            assert!(report.error.theta.abs() < 1e-9);
        }
    }
}

/// From a route to an order and back, and to a goal: where a base that was driven ends it parks as any other.
#[test]
fn other_tasks_go_on_from_an_order() {
    for (name, base) in BASES {
        let path = ConstantTwist {
            start: Pose::default(),
            twist: Twist::new(0.2, 0.1),
        };
        let mut robot = start(base, Body::default(), &Task::Follow(path.at::<Libm>(0.0)));
        for tick in 0..12_000 {
            let report = robot.advance(|t| match tick {
                0..500 => Task::Follow(path.at::<Libm>(t)),
                500..1000 => drive(-0.1, -0.2, true),
                1000..2000 => Task::Follow(path.at::<Libm>(t - 10.0)),
                2000..2500 => drive(0.2, 0.0, false),
                _ => Task::Park(Pose::new(1.0, 0.5, 0.3)),
            });
            let mode = match tick {
                500..1000 | 2000..2500 => Mode::Driving,
                2500.. => Mode::Parking,
                _ => Mode::Following,
            };
            assert_eq!(report.mode, mode);
        }
        let (at, outcome) = (robot.body.pose, robot.report().outcome);
        assert_eq!(outcome, controller_core::Outcome::Parked, "{name}");
        let off = (at.x - 1.0).hypot(at.y - 0.5);
        assert!(
            off < 1e-3 && (at.theta - 0.3).abs() < 1e-3,
            "{name}: {at:?}"
        );
    }
}
