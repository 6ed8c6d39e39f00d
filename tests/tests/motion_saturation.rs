//! Wheels at their limit: nothing winds up, nothing is lost.

use controller_core::motion::{Limits, Outcome, SaturationPolicy, Task};
use controller_core::types::{Pose, Twist, WheelTorques, Wrench};
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Order, goal, steady};
use tests::motion_tracking::{Exact, follow};
use tests::stated::{At, Stated};
use tests::tolerance::ARRIVED;

/// Wheels that make 10 N together, on a base that believes in 1.5 m/s².
fn overrated() -> Base {
    let limits = Limits {
        wheel_torque_nm: 0.5,
        ..Base::STANDARD.limits
    };
    Base {
        limits,
        ..Base::STANDARD
    }
}

/// 1 m/s from rest with wheels of 10 N, held back by 12 N from 4 to 8 s: the force at release goes on as it was and the
/// way lost is caught up without overshoot.
#[test]
fn release_is_continuous_and_recovery_monotone() {
    let base = overrated();
    let motion = base.exact().validate().expect("valid");
    let path = steady(1.0, 0.0);
    let mut drive = Exact::start(&motion, base, Body::default(), &path(0.0), 0.01);
    let limit = motion.force_rate_limit() * drive.dt;
    let mut saturated = 0;
    let (mut last, mut lag, mut largest_change) = (0.0, f64::INFINITY, 0.0_f64);
    let mut largest_lag = 0.0_f64;
    while drive.t < 60.0 {
        let held = (4.0..8.0).contains(&drive.t);
        let push = Wrench {
            force: if held { -12.0 } else { 0.0 },
            moment: 0.0,
        };
        drive.coast(&push);
        drive.take(&path(drive.t), &drive.body.measured());
        saturated += i32::from(drive.report().limited.torque);
        let force = drive.applied().force;
        if drive.t > 7.9 {
            largest_change = largest_change.max((force - last).abs());
        }
        last = force;
        let error = drive.error(&path(drive.t)).x;
        largest_lag = largest_lag.max(error);
        // It takes 3 s to be as fast as the reference again; from then on the lag only falls.
        if drive.t > 11.0 {
            assert!(error <= lag + 1e-9, "lag rises to {error} at {} s", drive.t);
            assert!(error > -1e-3, "overshoot {error} at {} s", drive.t);
            lag = error;
        }
    }
    println!(
        "saturated {saturated} ticks, lag {largest_lag:.2} m, then {lag:.1e} m, change {largest_change:.3} N of {limit:.1} N"
    );
    assert!(saturated > 100 && largest_lag > 1.0 && lag < 1e-3);
    assert!(largest_change <= limit);
    Stated::of("docs/motion.md").exactly(
        At::Phrase("the lag of # m falls monotonically, the force at release changes by # N of # N allowed"),
        &[largest_lag, largest_change, limit],
    );
}

/// Case 2 with 10 N and 5 N m, and any policy: the paper's law loses it; this one arrives, late.
#[test]
fn case_2_with_weak_wheels_arrives_late() {
    let start = Body::at(0.0, 1.0, 0.0);
    let times = [
        SaturationPolicy::KeepCurvature,
        SaturationPolicy::TurnFirst,
        SaturationPolicy::DriveFirst,
    ]
    .map(|policy| {
        let base = Base::WEAK.with_policy(policy);
        let motion = base.exact().validate().expect("valid");
        let run = follow(&motion, base, start, 0.01, 40.0, steady(0.4, 0.15));
        println!(
            "{policy:?}: on the path at {:.1} s, left {:.1e} m",
            run.settled_s, run.late
        );
        assert!(
            (8.0..20.0).contains(&run.settled_s),
            "{policy:?}: {} s",
            run.settled_s
        );
        run.settled_s
    });
    let base = Base::WEAK;
    let motion = base.exact().validate().expect("valid");
    let path = steady(0.4, 0.15);
    let target = goal(&path(10.0));
    let mut drive = Exact::start(&motion, base, start, &path(0.0), 0.01);
    let mut parking = false;
    let mut parked_s = 0.0;
    while drive.t < 60.0 {
        let left = (10.0 - drive.t).max(0.0) * 0.4 + drive.error(&path(drive.t)).x;
        parking |=
            left <= motion.hand_over_distance(drive.report().command.linear) || drive.t > 10.0;
        drive.advance(|t| if parking { Task::Park(target) } else { path(t) });
        if drive.report().outcome != Outcome::Parked {
            parked_s = drive.t;
        }
    }
    let error = drive.error(&Task::Park(target));
    println!("case 2, weak: parked at {parked_s:.1} s, {error:?}");
    let left = error.x.hypot(error.y);
    assert!(parked_s < 40.0 && left < ARRIVED && error.theta.abs() < ARRIVED);
    let strong = Base::STANDARD;
    let motion = strong.exact().validate().expect("valid");
    let fast = follow(&motion, strong, start, 0.01, 40.0, steady(0.4, 0.15));
    Stated::of("docs/motion.md").exactly(
        At::Phrase(
            "10 N and 5 N m: on the path at # s instead of # s (# turn first, # drive first), \
             parked at # s, # mm and # mrad off",
        ),
        &[
            times[0],
            fast.settled_s,
            times[1],
            times[2],
            parked_s,
            1e3 * left,
            1e3 * error.theta.abs(),
        ],
    );
}

/// Gains of a strong base on wheels of 10 N: overrated limits, but the law knows the torque limit.
#[test]
fn overrated_base_still_parks() {
    let base = overrated();
    let motion = base.exact().validate().expect("valid");
    for (x, y, theta) in [(-1.0, 0.5, 0.0), (0.3, -0.8, 2.0), (-0.5, -0.5, -1.0)] {
        let target = Task::Park(Pose::default());
        let mut drive = Exact::start(&motion, base, Body::at(x, y, theta), &target, 0.01);
        while drive.t < 60.0 {
            drive.advance(|_| target);
        }
        println!(
            "overrated: {:?} {:?}",
            drive.report().outcome,
            drive.error(&target)
        );
        assert_eq!(drive.report().outcome, Outcome::Parked);
    }
}

/// Drives at `order` \[m/s\] for 6 s and stops, on drivers whose supply turns the wheels no faster than at `fastest` \[m/s\]: what a wheel can exert
/// falls to nothing over the last tenth of that speed. The way from the stop to rest \[m\]; the law is `told` what is exerted.
fn stops_within(order: f64, fastest: f64, told: bool) -> f64 {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let order = |t: f64| Task::Drive {
        twist: Twist::new(if t < 6.0 { order } else { 0.0 }, 0.0),
        hold_heading: true,
    };
    let mut drive = Exact::start(&motion, base, Body::default(), &order(0.0), 0.01);
    let mut from = 0.0;
    while drive.t < 12.0 {
        let left = ((fastest - drive.body.twist.linear) / (0.1 * fastest)).max(0.0);
        let most = base.limits.wheel_torque_nm * left;
        let asked = drive.report().torques;
        let exerted = WheelTorques {
            right: asked.right.min(most),
            left: asked.left.min(most),
        };
        let wheels = motion.wheels();
        let (is, due) = (wheels.wrench(&exerted), wheels.wrench(&asked));
        if told && exerted != asked {
            drive.controller.note_applied(&exerted).expect("finite");
        }
        drive.coast(&Wrench {
            force: is.force - due.force,
            moment: is.moment - due.moment,
        });
        if drive.t <= 6.0 {
            from = drive.body.pose.x;
        }
        drive.take(&order(drive.t), &drive.body.measured());
    }
    assert!(drive.body.twist.linear.abs() < 1e-3, "it goes on");
    drive.body.pose.x - from
}

/// The command does not run ahead of what a weak supply turns the wheels with: ordered faster, a base stops within 2 % of the way that it takes from
/// the same speed by order. Who does not tell what is exerted goes on for as long as the command takes to come down.
#[test]
fn a_command_does_not_run_ahead_of_a_weak_supply() {
    for fastest in [0.8, 1.2, 1.6] {
        let by_order = stops_within(fastest, 1e9, false);
        let told = stops_within(2.0, fastest, true);
        let silent = stops_within(2.0, fastest, false);
        println!("{fastest} m/s: {told:.3} m told, {silent:.3} silent, {by_order:.3} by order");
        assert!(told < 1.02 * by_order && silent > 1.2 * by_order);
    }
}

/// A driver that measures its torque, 20 % less than it is asked for, is no driver at its limit: the base gets as fast as asked, and its command
/// goes by its own limits.
#[test]
fn a_motor_constant_that_is_off_holds_nothing_back() {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let order: Order = Task::Drive {
        twist: Twist::new(1.0, 0.5),
        hold_heading: true,
    };
    let mut drive = Exact::start(&motion, base, Body::default(), &order, 0.01);
    while drive.t < 3.0 {
        let asked = drive.report().torques;
        let less = drive.applied();
        let exerted = WheelTorques {
            right: 0.8 * asked.right,
            left: 0.8 * asked.left,
        };
        drive.controller.note_applied(&exerted).expect("finite");
        assert!(!drive.report().limited.torque, "held at {} s", drive.t);
        drive.coast(&Wrench {
            force: -0.2 * less.force,
            moment: -0.2 * less.moment,
        });
        drive.take(&order, &drive.body.measured());
    }
    println!("{:?}", drive.body.twist);
    assert!((drive.body.twist.linear - 1.0).abs() < 0.01);
}
