//! Leaving the path at the distance that the controller names: no overshoot, no step.

use controller_core::maths::Libm;
use controller_core::motion::{Outcome, Remaining, Task};
use controller_core::pose_error::{PoseError, pose_error};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use tests::motion_base::{Base, Body};
use tests::motion_loop::{goal, steady};
use tests::motion_tracking::Exact;
use tests::stated::{At, Stated};
use tests::tolerance::{ARRIVED, MOTION_OVERSHOOT};

/// What came of a path with its end as the goal.
#[derive(Debug)]
struct Mission {
    /// Distance to the goal at the hand-over \[m\].
    distance: f64,
    /// Farthest beyond the goal, in its direction \[m\].
    overshoot: f64,
    /// Largest change of wheel torque in a tick in the second before the hand-over, and in it \[N m\].
    change: (f64, f64),
    /// When parked for good \[s\].
    parked_s: f64,
    /// Left in the end.
    left: f64,
    /// Left in the end.
    left_theta: f64,
}

/// Follows (v, w) for a way of `length`, changes to parking by distance, parks at the end of it.
fn mission(base: Base, body: Body, v: f64, w: f64, length: f64) -> Mission {
    let motion = base.exact().validate().expect("valid");
    let path = steady(v, w);
    let end_s = length / v.abs();
    let target = goal(&path(end_s));
    let mut drive = Exact::start(&motion, base, body, &path(0.0), 0.01);
    let mut parking = false;
    let mut last = drive.applied();
    let mut seen = Mission {
        distance: 0.0,
        overshoot: f64::NEG_INFINITY,
        change: (0.0, 0.0),
        parked_s: f64::NAN,
        left: 0.0,
        left_theta: 0.0,
    };
    let mut recent = Vec::new();
    while drive.t < end_s + 60.0 {
        let before = drive.t + drive.dt;
        let error = drive.error(&path(drive.t));
        let remaining = (end_s - before).max(0.0) * v.abs() + error.x * v.signum();
        let speed = drive.report().command.linear;
        let hand_over = !parking && remaining <= motion.hand_over_distance(speed);
        parking |= hand_over || before > end_s;
        drive.advance(|t| if parking { Task::Park(target) } else { path(t) });
        let applied = drive.applied();
        let change = Base::wheel_norm(applied.force - last.force, applied.moment - last.moment);
        last = applied;
        if hand_over {
            seen.distance = drive.error(&Task::Park(target)).x.abs();
            let from = recent.len() - 100;
            seen.change = (recent[from..].iter().copied().fold(0.0, f64::max), change);
            assert!(drive.report().jumped);
        }
        recent.push(change);
        if parking {
            let past = pose_error::<f64, Libm>(&drive.body.pose, &target);
            seen.overshoot = seen.overshoot.max(past.x * v.signum());
        }
        if drive.report().outcome != Outcome::Parked {
            seen.parked_s = drive.t;
        }
    }
    let left = drive.error(&Task::Park(target));
    seen.left = left.x.hypot(left.y);
    seen.left_theta = left.theta.abs();
    seen
}

fn check(name: &str, seen: &Mission) {
    println!(
        "{name}: at {:.3} m, overshoot {:.3} mm, change before {:.1e} and in it {:.1e} N m, parked {:.1} s, left {:.2} mm {:.2} mrad",
        seen.distance,
        1e3 * seen.overshoot,
        seen.change.0,
        seen.change.1,
        seen.parked_s,
        1e3 * seen.left,
        1e3 * seen.left_theta
    );
    assert!(seen.overshoot < MOTION_OVERSHOOT, "{name}: {seen:?}");
    assert!(
        seen.left < ARRIVED && seen.left_theta < ARRIVED,
        "{name}: {seen:?}"
    );
    // No step: the tick of the hand-over is like those before it, but for what feedback still held: less than a
    // hundred-thousandth of the wheels' limit.
    let felt = 1e-5 * Base::STANDARD.limits.wheel_torque_nm;
    assert!(seen.change.1 <= seen.change.0 + felt, "{name}: {seen:?}");
}

/// Lines at any speed, with 10 N and 5 N m as well, and case 2: the arc from rest 1 m beside it.
#[test]
fn paths_end_without_overshoot() {
    let mut short = Vec::new();
    for v in [0.1, 0.4, 1.0, 2.0, -0.1, -0.4, -1.0] {
        let start = Body::at(0.0, -0.1, 0.0);
        let seen = mission(Base::STANDARD, start, v, 0.0, 8.0);
        check(&format!("line at {v} m/s"), &seen);
        short.push(-1e3 * seen.overshoot);
    }
    for v in [0.1, 0.4, 1.0, -0.4] {
        let start = Body::at(0.0, -0.1, 0.0);
        let seen = mission(Base::WEAK, start, v, 0.0, 12.0);
        check(&format!("weak, line at {v} m/s"), &seen);
        short.push(-1e3 * seen.overshoot);
    }
    let seen = mission(Base::STANDARD, Body::at(0.0, 1.0, 0.0), 0.4, 0.15, 4.0);
    check("case 2", &seen);
    assert!(seen.parked_s < 20.0);
    short.push(-1e3 * seen.overshoot);
    let least = short.iter().copied().fold(f64::INFINITY, f64::min);
    let most = short.iter().copied().fold(0.0, f64::max);
    Stated::of("docs/motion.md").exactly(
        At::Phrase("no overshoot beyond the latch (the robot stops # to # mm short"),
        &[least, most],
    );
}

/// A goal too near for anything else than parking is handed over at once, and reached.
#[test]
fn braking_distance_covers_any_speed() {
    let motion = Base::STANDARD.exact().validate().expect("valid");
    assert_eq!(motion.hand_over_distance(0.0), 0.05);
    let mut last = 0.0;
    for k in 0..=250 {
        let v = 0.01 * f64::from(k);
        let distance = motion.hand_over_distance(v);
        assert!(
            distance >= last && distance >= v * v / (2.0 * 1.5),
            "{v} m/s: {distance}"
        );
        assert_eq!(distance, motion.hand_over_distance(-v));
        last = distance;
    }
}

/// A robot behind its reference has that much farther to go, whichever way it drives; what it has to turn is not changed.
#[test]
fn what_is_left_counts_how_far_the_robot_is_behind() {
    let left = Remaining {
        path_m: 1.0,
        turn_rad: 0.7,
    };
    let error = PoseError {
        x: 0.25,
        y: 5.0,
        theta: 1.0,
    };
    for (speed, path_m) in [(0.4, 1.25), (0.0, 1.25), (-0.4, 0.75)] {
        let reference = Reference::new(Pose::default(), Twist::new(speed, 0.2), Accel::default());
        let found = left.with_error(&reference, &error);
        assert_eq!(
            (found.path_m, found.turn_rad),
            (path_m, 0.7),
            "at {speed} m/s"
        );
    }
}

/// Parking takes over when both the path and the turn are short, each by the distance that parking needs.
#[test]
fn parking_is_due_when_path_and_turn_are_short() {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let (v, w) = (0.8, 0.9);
    let command = Twist::new(v, w);
    // A wheel's rim is as fast as the root of both squares says.
    let along = motion.hand_over_distance(v);
    let around = motion.hand_over_distance(v.hypot(0.5 * base.track * w)) / (0.5 * base.track);
    assert!(along > 0.06 && around > 0.06, "beyond the least distance");
    for (path, turn, due) in [
        (0.99, 0.99, true),
        (1.01, 0.99, false),
        (0.99, 1.01, false),
        (1.01, 1.01, false),
    ] {
        let left = Remaining {
            path_m: path * along,
            turn_rad: turn * around,
        };
        assert_eq!(
            motion.parking_is_due::<Libm>(&left, &command),
            due,
            "{path} of the path, {turn} of the turn"
        );
    }
}
