//! Arrived, held or released, pushed away, stuck.

use controller_core::motion::{AtRest, MotionParams, Outcome, Task, ValidMotionParams};
use controller_core::types::{Pose, Wrench};
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Order, steady};
use tests::motion_tracking::Exact;
use tests::tolerance::ARRIVED;

const BASE: Base = Base::STANDARD;
const HOME: Order = Task::Park(Pose::new(0.0, 0.0, 0.0));

fn motion(change: impl Fn(&mut MotionParams<f64>)) -> ValidMotionParams<f64> {
    let mut params = BASE.exact();
    change(&mut params);
    params.validate().expect("valid")
}

/// Runs to `until` with a push.
fn run(drive: &mut Exact, order: &Order, push: f64, until: f64) {
    let wrench = Wrench {
        force: push,
        moment: 0.0,
    };
    while drive.t < until {
        drive.coast(&wrench);
        drive.take(order, &drive.body.measured());
    }
}

fn parked(motion: &ValidMotionParams<f64>) -> Exact {
    let mut drive = Exact::start(motion, BASE, Body::at(-0.5, 0.1, 0.2), &HOME, 0.01);
    run(&mut drive, &HOME, 0.0, 20.0);
    assert_eq!(drive.report().outcome, Outcome::Parked);
    drive
}

/// At the goal from the first tick: parked after the dwell, not before.
#[test]
fn arrival_takes_its_dwell() {
    for dwell in [0.0, 0.05, 0.5] {
        let motion = motion(|params| params.arrival.dwell_s = dwell);
        let mut drive = Exact::start(&motion, BASE, Body::default(), &HOME, 0.01);
        assert_eq!(drive.report().outcome, Outcome::Driving);
        let mut since = f64::NAN;
        while drive.t < 1.0 {
            let outcome = drive.advance(|_| HOME).outcome;
            if outcome == Outcome::Parked && since.is_nan() {
                since = drive.t;
            }
        }
        assert!(
            since > dwell - 1e-9 && since <= dwell + 0.021,
            "{dwell}: {since}"
        );
    }
}

/// A robot that passes the goal at speed has not arrived.
#[test]
fn passing_by_is_no_arrival() {
    let motion = motion(|_| ());
    let mut body = Body::at(-0.3, 0.0, 0.0);
    body.twist.linear = 1.5;
    let mut drive = Exact::start(&motion, BASE, body, &HOME, 0.001);
    while drive.body.twist.linear > 0.02 {
        assert_eq!(drive.advance(|_| HOME).outcome, Outcome::Driving);
    }
    run(&mut drive, &HOME, 0.0, 20.0);
    assert_eq!(drive.report().outcome, Outcome::Parked);
}

/// Parked stays parked within twice the distance, and not beyond.
#[test]
fn parked_state_has_hysteresis() {
    let motion = motion(|params| params.arrival.distance_m = 1e-3);
    let drive = parked(&motion);
    for (moved, outcome) in [(0.9e-3, Outcome::Parked), (5e-3, Outcome::Driving)] {
        let mut drive = drive;
        drive.body.pose = Pose::new(moved, 0.0, 0.0);
        run(&mut drive, &HOME, 0.0, 20.05);
        assert_eq!(drive.report().outcome, outcome, "moved {moved}");
        run(&mut drive, &HOME, 0.0, 30.0);
        assert_eq!(drive.report().outcome, Outcome::Parked);
    }
    // Outside of what it takes to arrive, inside of what it takes to leave.
    let mut drive = drive;
    drive.body.pose = Pose::new(1.5e-3, 0.0, 0.0);
    run(&mut drive, &HOME, 0.0, 21.0);
    assert_eq!(drive.report().outcome, Outcome::Parked);
    assert!(drive.body.pose.x > 1.4e-3);
}

/// Held: no torque without a push, resistance against one, and back to the goal when it was too strong.
#[test]
fn held_robot_resists() {
    let mut drive = parked(&motion(|_| ()));
    assert!(drive.applied().force.abs() < 1e-9 && drive.applied().moment.abs() < 1e-9);
    run(&mut drive, &HOME, 2.0, 22.0);
    assert!(drive.applied().force < -1.0);
    run(&mut drive, &HOME, 0.0, 45.0);
    assert_eq!(drive.report().outcome, Outcome::Parked);
    assert!(drive.error(&HOME).x.abs() < ARRIVED);
}

/// Released: exactly no torque; a push moves it freely until it is off the goal, then torque sets in by at most L dt per
/// tick and brings it back.
#[test]
fn released_robot_lets_go() {
    let motion = motion(|params| {
        params.arrival.at_rest = AtRest::Release;
        params.arrival.distance_m = 0.02;
        params.arrival.heading_rad = 0.02;
    });
    let mut drive = parked(&motion);
    assert_eq!(drive.applied(), Wrench::default());
    let limit = motion.force_rate_limit() * drive.dt;
    let mut last = 0.0;
    let mut free = 0;
    while drive.t < 40.0 {
        let push = if drive.t < 21.0 { 30.0 } else { 0.0 };
        drive.coast(&Wrench {
            force: push,
            moment: 0.0,
        });
        drive.take(&HOME, &drive.body.measured());
        let force = drive.applied().force;
        let pushed = 30.0 * 3.0 * drive.dt;
        assert!(
            (force - last).abs() <= limit + pushed,
            "{force} after {last}"
        );
        if drive.report().outcome == Outcome::Parked && drive.t < 21.0 {
            assert_eq!(force, 0.0);
            free += 1;
        }
        last = force;
    }
    assert!(free > 5);
    assert_eq!(drive.report().outcome, Outcome::Parked);
    assert_eq!(drive.applied(), Wrench::default());
}

/// A robot against a wall is stalled after 2 s of trying, following or parking, strong or weak, and drives on when free.
#[test]
fn robot_that_cannot_move_is_stalled() {
    for base in [Base::STANDARD, Base::WEAK] {
        let motion = base.exact().validate().expect("valid");
        let stall = motion.params().arrival.stall_s;
        for order in [Task::Park(Pose::new(2.0, 0.3, 0.0)), steady(0.4, 0.1)(5.0)] {
            let mut drive = Exact::start(&motion, base, Body::default(), &order, 0.01);
            let mut since = f64::NAN;
            for k in 1..=1000 {
                let measured = Body::default().measured();
                if drive.take(&order, &measured).outcome == Outcome::Stalled && since.is_nan() {
                    since = 0.01 * f64::from(k);
                }
            }
            println!("stalled after {since:.2} s of {stall} s");
            assert!(since > stall && since < stall + 1.5, "{since}");
            // Free again.
            drive.body = Body::default();
            let mut outcome = Outcome::Stalled;
            for _ in 0..300 {
                outcome = drive.advance(|_| order).outcome;
            }
            assert_eq!(outcome, Outcome::Driving);
        }
    }
}

/// Standing on purpose is no stall.
#[test]
fn standing_on_purpose_is_no_stall() {
    let motion = motion(|_| ());
    let order = steady(0.0, 0.0)(0.0);
    let mut drive = Exact::start(&motion, BASE, Body::default(), &order, 0.01);
    while drive.t < 10.0 {
        assert_eq!(drive.advance(|_| order).outcome, Outcome::Driving);
    }
    let mut drive = parked(&motion);
    run(&mut drive, &HOME, 0.0, 40.0);
    assert_eq!(drive.report().outcome, Outcome::Parked);
}
