//! What README says of the default law, on the bases as they are shipped: their files' gains and limits, their own
//! control periods, exact poses.

use controller_core::maths::Libm;
use controller_core::motion::{Outcome, Task, ValidMotionParams};
use controller_core::shunting::ExactMean;
use controller_core::types::Pose;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{ring, steady};
use tests::motion_parking::{park_all, print};
use tests::motion_tracking::{Exact, follow};
use tests::stated::{At, Stated};
use tests::tolerance::MOTION_SETTLED_LATE;
use tests::tuning_loop::{BASES, file};

fn shipped(name: &str) -> (ValidMotionParams<f64>, Base, f64) {
    let file = file(name);
    let params = file.motion();
    let motion = params.validate().expect("valid");
    (motion, Base::of(&params), file.period_s())
}

/// Every start of the ring parks, on every base.
#[test]
fn every_shipped_base_parks_from_anywhere() {
    let mut readme = Stated::of("README.md");
    let (mut runs, mut distance, mut heading) = (0, 0.0_f64, 0.0_f64);
    let mut last_s = Vec::new();
    for name in BASES {
        let (motion, base, dt) = shipped(name);
        let starts = ring();
        let parked = park_all::<f64, Libm, ExactMean>(&motion, base, &starts, dt, 40.0);
        let all = print(name, &parked);
        assert_eq!(all.lost, 0, "{name}");
        runs += starts.len();
        distance = distance.max(all.left.x.hypot(all.left.y));
        heading = heading.max(all.left.theta);
        last_s.push(all.arrived_s);
    }
    readme.exactly(
        At::Phrase("forward or backward: # starts from rest, 0.1 to 3 m"),
        &[runs as f64],
    );
    readme.exactly(
        At::Phrase("the last after # s (1 kg), # s (10 kg), # s (30 kg)"),
        &last_s,
    );
    readme.at_most(
        At::Phrase("on the three bases, within # mm and # mrad"),
        &[1e3 * distance, 1e3 * heading],
    );
}

/// An offset of 0.1 m beside a straight line goes in about the same time from 0.1 m/s to the base's own top speed.
#[test]
fn every_shipped_base_settles_at_any_speed() {
    let mut times = Vec::new();
    for name in BASES {
        let (motion, base, dt) = shipped(name);
        let settled = [0.1, 0.8 * motion.params().limits.speed].map(|v| {
            let mut body = Body::at(0.0, -0.1, 0.0);
            body.twist.linear = v;
            let run = follow(&motion, base, body, dt, 20.0, steady(v, 0.0));
            assert!(
                run.late < MOTION_SETTLED_LATE,
                "{name}, {v} m/s: {}",
                run.late
            );
            run.settled_s
        });
        times.extend(settled);
    }
    Stated::of("README.md").exactly(
        At::Phrase(
            "0.1 m of offset settles, at 0.1 m/s and at 80 % of the top speed, in # and # s (1 kg), # and # s (10 kg), # and # s (30 kg)",
        ),
        &times,
    );
}

/// Told that its wheels slide, whenever that is on its way, every base goes on with half the accelerations, and parks; the next goal gets all of them again.
#[test]
fn wheels_that_slide_are_asked_for_half_the_accelerations() {
    for name in BASES {
        let (motion, base, dt) = shipped(name);
        let limits = &motion.params().limits;
        // Shares of both limits that the last tick fed forward.
        let asked = |drive: &Exact| {
            let rate = drive.report().command_rate;
            let linear = rate.linear.abs() / limits.accel.min(limits.brake);
            linear.max(rate.angular.abs() / limits.turn_accel)
        };
        let ramp_s = 2.0 * (limits.accel / limits.jerk).max(limits.turn_accel / limits.turn_jerk);
        let goals = [Pose::new(0.0, 0.0, 0.0), Pose::new(1.5, -0.6, 1.0)].map(Task::Park);
        let mut slid = 0;
        for from_s in (0..30).map(|k| 0.1 * f64::from(k)) {
            let start = Body::at(-1.2, 0.5, 2.0);
            let mut drive = Exact::start(&motion, base, start, &goals[0], dt);
            while drive.t < 30.0 && drive.report().outcome != Outcome::Parked {
                let slides = (from_s..from_s + 0.2).contains(&drive.t);
                if slides {
                    drive.controller.declare_slide();
                }
                drive.advance(|_| goals[0]);
                let yields = drive.report().limited.grip;
                // Not while it is said to slide: a search under way ends first.
                if yields && drive.t > from_s + 0.2 + ramp_s {
                    let asked = asked(&drive);
                    // Half of what is planned with, and as much again of the rest for the follower, which has all limits.
                    assert!(asked < 0.75, "{name}, {from_s}: {asked} at {}", drive.t);
                }
            }
            assert_eq!(drive.report().outcome, Outcome::Parked, "{name}, {from_s}");
            slid += u32::from(drive.report().limited.grip);
            let mut most = 0.0_f64;
            while drive.t < 60.0 && (most == 0.0 || drive.report().outcome != Outcome::Parked) {
                drive.advance(|_| goals[1]);
                assert!(!drive.report().limited.grip);
                most = most.max(asked(&drive));
            }
            assert_eq!(drive.report().outcome, Outcome::Parked, "{name}, {from_s}");
            assert!(most > 0.9, "{name}, {from_s}: {most}");
        }
        // The manoeuvre begins after a search, and is over after a time.
        assert!((15..=30).contains(&slid), "{name}: {slid}");
    }
}
