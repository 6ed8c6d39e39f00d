//! What the real world adds: moving goals, uneven ticks, wrong masses, late poses, far from the origin.

use std::f64::consts::PI;

use controller_core::maths::{Libm, Single};
use controller_core::motion::{
    JumpThreshold, Limits, MotionController, MotionParams, Outcome, SaturationPolicy, Task,
};
use controller_core::pose_error::pose_error;
use controller_core::robot::Robot;
use controller_core::shunting::{ExactMean, RationalMean};
use controller_core::types::{Measured, Pose};
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, Order, goal, ring, steady};
use tests::motion_parking::{park_all, print};
use tests::motion_tracking::Exact;
use tests::random::Random;
use tests::stated::{At, Stated};
use tests::tolerance::ARRIVED;

const BASE: Base = Base::STANDARD;

/// A goal that trembles at every tick by ±1 mm and ±1 mrad (a detected dock) is a jump at every tick, and reached.
#[test]
fn goal_that_changes_at_every_tick_is_reached() {
    let mut params = BASE.exact();
    params.pose_noise_m = 1e-3;
    let motion = params.validate().expect("valid");
    for (x, y, theta) in [(-1.0, 0.3, 0.0), (-0.5, -0.5, 1.0), (1.0, 0.2, 0.3)] {
        for dt in [0.01, 0.001] {
            let mut random = Random(0x5EED_0009);
            let still: Order = Task::Park(Pose::default());
            let mut drive = Exact::start(&motion, BASE, Body::at(x, y, theta), &still, dt);
            while drive.t < 20.0 {
                let goal = Pose::new(
                    random.within(1e-3),
                    random.within(1e-3),
                    random.within(1e-3),
                );
                drive.advance(|_| Task::Park(goal));
            }
            let left = drive.error(&still);
            println!("trembling goal: {left:?}");
            assert!(
                left.x.hypot(left.y) < 0.01 && left.theta.abs() < 0.02,
                "{left:?}"
            );
        }
    }
}

/// A threshold below the noise makes every tick a jump; the robot follows all the same.
#[test]
fn threshold_below_the_noise_does_no_harm() {
    let mut params = BASE.exact();
    params.jump = Some(JumpThreshold {
        distance_m: 1e-4,
        heading_rad: 1e-4,
    });
    let motion = params.validate().expect("valid");
    let path = steady(0.4, 0.15);
    let mut random = Random(0x5EED_000A);
    let mut drive = Exact::start(&motion, BASE, Body::at(0.0, 0.5, 0.0), &path(0.0), 0.01);
    let mut jumps = 0;
    while drive.t < 20.0 {
        drive.coast(&Default::default());
        let mut measured = drive.body.measured::<f64>();
        measured.pose.x += random.within(0.05);
        measured.pose.y += random.within(0.05);
        jumps += i32::from(drive.take(&path(drive.t), &measured).jumped);
    }
    let left = drive.error(&path(drive.t));
    println!("{jumps} jumps of 2000, left {left:?}");
    assert!(jumps > 500);
    assert!(left.x.hypot(left.y) < 0.05, "{left:?}");
}

/// Ticks anywhere from 2 to 30 ms.
#[test]
fn uneven_ticks_park() {
    let motion = BASE.params::<f32, Single>().validate().expect("valid");
    let order = Task::Park(Pose::default());
    let starts: Vec<Body> = ring().into_iter().step_by(7).collect();
    let lost = on_all_cores(&starts, |body| {
        let mut random = Random(0x5EED_000B);
        let mut drive =
            Drive::<f32, Single, RationalMean>::start(&motion, BASE, *body, &order, 0.01);
        let mut t = 0.0;
        while t < 20.0 {
            drive.dt = 0.016 + random.within(0.014);
            t += drive.dt;
            drive.advance(|_| order);
        }
        let left = drive.error(&order);
        let parked = drive.report().outcome == Outcome::Parked;
        !(parked && left.x.hypot(left.y) < ARRIVED && left.theta.abs() < ARRIVED)
    });
    assert_eq!(lost.into_iter().filter(|lost| *lost).count(), 0);
}

/// Single precision 200 m from the origin: poses come in steps of 15 µm.
#[test]
fn single_precision_parks_far_from_the_origin() {
    let motion = BASE.params::<f32, Single>().validate().expect("valid");
    let order = Task::Park(Pose::new(200.0, -150.0, 3.0));
    for bearing in 0..12 {
        let (sine, cosine) = (f64::from(bearing) * PI / 6.0).sin_cos();
        let body = Body::at(200.0 + cosine, -150.0 + sine, 1.0);
        let mut drive =
            Drive::<f32, Single, RationalMean>::start(&motion, BASE, body, &order, 0.01);
        while drive.t < 20.0 {
            drive.advance(|_| order);
        }
        let left = drive.error(&order);
        assert_eq!(drive.report().outcome, Outcome::Parked, "{left:?}");
        assert!(left.x.hypot(left.y) < ARRIVED && left.theta.abs() < ARRIVED);
    }
}

/// Largest heading beyond the goal \[rad\] of a robot that turns through `goal`, though its wheels accelerate its turning by `share` of the
/// limit only; parked in the end.
fn turned_past(share: f64, goal: f64) -> f64 {
    const DT: f64 = 0.01;
    let params = MotionParams::new(Robot::paper(), Limits::PAPER);
    let most = share * params.limits.turn_accel * DT;
    let motion = params.validate().expect("valid");
    let task = Task::Park(Pose::new(0.0, 0.0, goal));
    let mut now = Measured::default();
    let mut controller: MotionController<f64, Libm> =
        MotionController::start(&motion, &task, &now).expect("finite");
    let mut past = 0.0_f64;
    for _ in 0..3000 {
        let report = controller.step(DT, &task, &now).expect("finite");
        let wanted = report.command.angular - now.twist.angular;
        now.twist.angular += wanted.clamp(-most, most);
        now.pose.theta += DT * now.twist.angular;
        past = past.max((now.pose.theta - goal) * goal.signum());
    }
    assert_eq!(controller.report().outcome, Outcome::Parked);
    past
}

/// A robot whose turning accelerates by less than a manoeuvre plans lags behind it. What it takes back of that it has to brake as well.
#[test]
fn a_robot_that_turns_up_late_turns_past_its_goal_by_what_is_stated() {
    let past = [1.0, 0.9, 0.8].map(|share| {
        let (left, right) = (turned_past(share, 2.0), turned_past(share, -2.0));
        println!("{share}: {:.1} {:.1} mrad", 1e3 * left, 1e3 * right);
        1e3 * left.max(right)
    });
    Stated::of("docs/motion.md").exactly(
        At::Phrase("with all of it # mrad, with nine tenths # mrad and with eight # mrad"),
        &past,
    );
}

/// Case 2 and parking at its end, with another robot than the controller believes in, and poses `late` ticks old.
fn mission(plant: Base, late: usize, limits: Limits<f64>, estimate: bool) -> (f64, f64, bool) {
    let mut params = Base { limits, ..BASE }.exact();
    if !estimate {
        params.gains.disturbance = 0.0;
    }
    let motion = params.validate().expect("valid");
    let path = steady(0.4, 0.15);
    let target = goal(&path(10.0));
    let order = Task::Park(target);
    let mut drive = Exact::start(&motion, plant, Body::at(0.0, 1.0, 0.0), &path(0.0), 0.01);
    let mut poses = vec![drive.body.pose; late + 1];
    let (mut parking, mut overshoot) = (false, 0.0_f64);
    while drive.t < 40.0 {
        let left = (10.0 - drive.t).max(0.0) * 0.4 + drive.error(&path(drive.t)).x;
        let speed = drive.report().command.linear;
        parking |= left <= motion.hand_over_distance(speed) || drive.t > 10.0;
        drive.coast(&Default::default());
        poses.push(drive.body.pose);
        let mut measured = drive.body.measured::<f64>();
        measured.pose = poses[poses.len() - 1 - late];
        let now = if parking { order } else { path(drive.t) };
        drive.take(&now, &measured);
        if parking {
            let past = pose_error::<f64, Libm>(&drive.body.pose, &target);
            overshoot = overshoot.max(past.x);
        }
    }
    let left = drive.error(&order);
    let parked = drive.report().outcome == Outcome::Parked;
    (overshoot, left.x.hypot(left.y), parked)
}

/// Wrong masses and late poses cost millimetres of overshoot, not the goal.
#[test]
fn wrong_masses_and_late_poses_still_park() {
    let mut seen = Vec::new();
    for (name, mass, inertia, late, most) in [
        ("as believed", 1.0, 1.0, 0, 5e-4),
        ("m 1.3, I 0.7", 1.3, 0.7, 0, 6e-3),
        // Twice the mass brakes later than the wheels can: a manoeuvre brakes with nearly all that the limits name, and then it drives out by 5 cm.
        ("m 2, I 2", 2.0, 2.0, 0, 0.06),
        // The estimate is slow to believe that a robot brakes too easily.
        ("m 0.5, I 0.5", 0.5, 0.5, 0, 1e-3),
        // A pose that is late by τ looks v τ behind: feedback drives ahead by that, and a robot that brakes at the limits has not
        // taken it back when it stands.
        ("20 ms late", 1.0, 1.0, 2, 0.02 * 0.4),
        ("50 ms late", 1.0, 1.0, 5, 0.05 * 0.4),
        ("100 ms late", 1.0, 1.0, 10, 0.1 * 0.4),
        ("200 ms late", 1.0, 1.0, 20, 0.2 * 0.4),
    ] {
        let plant = Base {
            mass: mass * BASE.mass,
            inertia: inertia * BASE.inertia,
            ..BASE
        };
        let (overshoot, left, parked) = mission(plant, late, BASE.limits, true);
        let (alone, _, _) = mission(plant, late, BASE.limits, false);
        println!(
            "{name}: overshoot {:.2} mm, left {:.2} mm; without the estimate {:.2} mm",
            1e3 * overshoot,
            1e3 * left,
            1e3 * alone
        );
        assert!(parked && left < ARRIVED, "{name}: {left}");
        assert!(overshoot < most, "{name}: {overshoot}");
        seen.push((1e3 * overshoot, 1e3 * alone));
    }
    let [_, heavy, twice, half, late @ ..] = &seen[..] else {
        panic!("eight robots")
    };
    let mut page = Stated::of("docs/motion.md");
    page.exactly(
        At::Phrase("0.7 times: # mm; both twice: # mm; both half: # mm (#, # and # mm without"),
        &[heavy.0, twice.0, half.0, heavy.1, twice.1, half.1],
    );
    page.exactly(
        At::Phrase("Poses 20 / 50 / 100 / 200 ms late: # / # / # / # mm"),
        &late.iter().map(|run| run.0).collect::<Vec<_>>(),
    );
    page.exactly(
        At::Phrase("past its goal; believed slowly, # mm (`motion_robustness`)"),
        &[half.0],
    );
}

/// Braking and speeding up apart.
#[test]
fn unequal_braking_does_not_overshoot() {
    for (accel, brake) in [(1.5, 0.5), (0.5, 3.0), (1.5, 0.2)] {
        let limits = Limits {
            accel,
            brake,
            ..BASE.limits
        };
        let (overshoot, left, parked) = mission(BASE, 0, limits, true);
        println!(
            "{accel}, {brake} m/s²: overshoot {:.3} mm, left {:.2} mm",
            1e3 * overshoot,
            1e3 * left
        );
        assert!(parked && overshoot < 5e-4);
    }
}

/// Wheels of 4 N m that saturate in every turn: no policy loses a pose of the ring.
#[test]
fn every_policy_parks_the_ring() {
    let times = [
        SaturationPolicy::KeepCurvature,
        SaturationPolicy::TurnFirst,
        SaturationPolicy::DriveFirst,
    ]
    .map(|policy| {
        let limits = Limits {
            wheel_torque_nm: 4.0,
            policy,
            ..BASE.limits
        };
        let base = Base { limits, ..BASE };
        let motion = base.exact().validate().expect("valid");
        let runs = park_all::<f64, Libm, ExactMean>(&motion, base, &ring(), 0.01, 40.0);
        let all = print(&format!("4 N m, {policy:?}"), &runs);
        assert_eq!(all.lost, 0);
        all.arrived_s
    });
    Stated::of("docs/motion.md").exactly(
        At::Phrase("by policy: # s (keep curvature), # s (turn first), # s (drive first)"),
        &times,
    );
}
