//! The control task on missions without faults.

#[path = "support/rig.rs"]
mod rig;

use controller_core::params::Params;
use controller_core::types::{Pose, Twist};
use firmware_demo::control::{ControlTask, LinkWatch, SettingError, Settings};
use firmware_demo::drive::MockDrive;
use firmware_demo::fault::Cause;
use firmware_demo::protocol::{Command, ParameterSet, RejectReason};
use firmware_demo::supervisor::State;
use rig::{MAX_TORQUE, Rig, params};

#[test]
fn complete_trajectory_ends_parked_at_its_last_reference() {
    let mut rig = Rig::at(Pose::new(-0.05, 0.02, 0.0));
    rig.run(10);
    assert_eq!(
        (rig.task.state(), rig.task.cause()),
        (State::Idle, Cause::PowerOn)
    );
    rig.command(Command::Arm).unwrap();
    rig.run(10);
    assert_eq!(
        rig.task.told(),
        Some(Default::default()),
        "armed: zero torque"
    );
    rig.line(40, true);
    rig.tick();
    assert_eq!(
        (rig.task.state(), rig.task.cause()),
        (State::Tracking, Cause::References)
    );
    let tracked = rig.run_until(5000, |rig| rig.task.state() == State::Parking);
    assert!(
        (3899..=3901).contains(&tracked),
        "3.9 s of references, {tracked}"
    );
    assert_eq!(rig.task.cause(), Cause::TrajectoryEnded);
    rig.run_until(8000, |rig| rig.task.state() == State::Parked);
    assert_eq!(rig.task.cause(), Cause::Reached);
    assert_eq!(rig.task.drive_mut().told(), None);
    let pose = rig.model.measured().pose;
    // 2 cm of tolerance along, 5 mm for what was left of the offset across.
    assert!(
        (pose.x - 1.56).abs() < 0.02 && pose.y.abs() < 0.005,
        "{pose:?}"
    );
}

#[test]
fn underrun_ends_in_a_smooth_stop_that_does_not_back_up() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.line(20, false);
    rig.run_until(2000, |rig| rig.task.cause() == Cause::Underrun);
    let start = rig.model.measured().pose.x;
    let (mut slowest, mut hardest) = (f32::MAX, 0.0_f32);
    let mut before = rig.speed();
    let ticks = rig.run_until(5000, |rig| {
        slowest = slowest.min(rig.speed());
        hardest = hardest.max((rig.speed() - before).abs());
        before = rig.speed();
        rig.task.state() == State::Stopped
    });
    assert_eq!(rig.task.drive_mut().told(), None);
    // The parking law is underdamped by a hair (0.91): back by less than 3 mm/s. 1 m/s^2 is a third of what the
    // torque limit allows.
    assert!(slowest > -0.003, "{slowest}");
    assert!(hardest < 1.0e-3, "{hardest}");
    assert!(ticks < 4500, "{ticks}");
    let way = rig.model.measured().pose.x - start;
    assert!((0.25..0.40).contains(&way), "v/k4 = 0.33 m ahead, {way}");
}

#[test]
fn parks_from_standstill_and_changes_its_goal_on_the_way() {
    let mut rig = Rig::new();
    assert_eq!(rig.park(1.0, 0.0, 0.0), Err(RejectReason::State));
    rig.command(Command::Arm).unwrap();
    assert_eq!(rig.park(f32::NAN, 0.0, 0.0), Err(RejectReason::Value));
    assert_eq!(rig.task.state(), State::Armed);
    rig.park(1.0, 0.0, 0.0).unwrap();
    rig.run(700);
    assert_eq!(rig.task.state(), State::Parking);
    let before = rig.speed();
    rig.park(2.0, 0.0, 0.0).unwrap();
    rig.tick();
    assert!(
        (rig.speed() - before).abs() < 2.0e-3,
        "no jerk at the new goal"
    );
    rig.run_until(15_000, |rig| rig.task.state() == State::Parked);
    assert!((rig.model.measured().pose.x - 2.0).abs() < 0.02);
    rig.park(1.5, 0.0, 0.0).unwrap();
    rig.run_until(15_000, |rig| rig.task.state() == State::Parked);
    assert!((rig.model.measured().pose.x - 1.5).abs() < 0.02);
}

#[test]
fn hands_over_from_tracking_without_a_torque_step() {
    let mut rig = Rig::tracking();
    let before = rig.task.told().unwrap();
    rig.park(1.5, 0.0, 0.0).unwrap();
    rig.tick();
    let step = rig.task.report().unwrap().hand_over_step.unwrap();
    assert!(
        step.force.abs() < 1e-3 && step.moment.abs() < 1e-3,
        "{step:?}"
    );
    let after = rig.task.told().unwrap();
    // One tick of the law besides: well below 1 % of the limit.
    assert!((after.right - before.right).abs() < 0.01 * MAX_TORQUE);
    rig.run_until(15_000, |rig| rig.task.state() == State::Parked);
}

#[test]
fn stops_on_request_and_runs_the_next_trajectory() {
    let mut rig = Rig::tracking();
    rig.command(Command::Stop).unwrap();
    rig.tick();
    assert_eq!(
        (rig.task.state(), rig.task.cause()),
        (State::Stopped, Cause::Host)
    );
    assert_eq!(rig.task.drive_mut().told(), None);
    // What is left of the first trajectory is gone, and times begin again.
    rig.run(10);
    rig.command(Command::Arm).unwrap();
    rig.run(10);
    assert_eq!(rig.task.state(), State::Armed);
    rig.line(30, false);
    rig.run(5);
    assert_eq!(rig.task.state(), State::Tracking);
}

#[test]
fn silent_host_stops_the_wheels_within_100_ms() {
    let mut rig = Rig::tracking();
    rig.command(Command::Heartbeat).unwrap();
    rig.host_alive = false;
    let ticks = rig.run_until(200, |rig| rig.task.told().is_none());
    assert!((90..=100).contains(&ticks), "{ticks}");
    assert_eq!(
        (rig.task.state(), rig.task.cause()),
        (State::Stopped, Cause::LinkLost)
    );
    // A host that comes back has to arm.
    rig.host_alive = true;
    rig.line(10, false);
    rig.run(50);
    assert_eq!(rig.task.state(), State::Stopped);
}

#[test]
fn link_watch_is_off_only_when_told_so() {
    let settings = |link| Settings {
        link,
        ..Settings::default()
    };
    assert!(matches!(
        Settings::default().link,
        LinkWatch::StopAfterUs(100_000)
    ));
    assert_eq!(
        settings(LinkWatch::StopAfterUs(0)).validate(),
        Err(SettingError::Link)
    );
    assert!(settings(LinkWatch::Off).validate().is_ok());
}

#[test]
fn parameters_change_at_rest_only_and_within_the_driver() {
    let set = |limit| {
        let mut set = ParameterSet::from(params().params());
        set.max_wheel_torque = limit;
        Command::SetParameters(set)
    };
    let mut rig = Rig::new();
    assert_eq!(rig.command(set(Some(2.0))), Ok(()));
    assert_eq!(
        rig.command(set(Some(2.0 * MAX_TORQUE))),
        Err(RejectReason::Value)
    );
    assert_eq!(rig.command(set(None)), Err(RejectReason::Value));
    assert_eq!(rig.command(set(Some(-1.0))), Err(RejectReason::Value));
    rig.command(Command::Arm).unwrap();
    assert_eq!(rig.command(set(Some(2.0))), Err(RejectReason::State));
    // The accepted limit is the one in force.
    rig.line(60, false);
    rig.model = firmware_demo::model::Model::new(
        params(),
        controller_core::types::Measured {
            pose: Pose::new(-3.0, 0.0, 0.0),
            twist: Twist::default(),
        },
    );
    let mut most = 0.0_f32;
    for _ in 0..1500 {
        rig.tick();
        most = most.max(rig.task.told().unwrap_or_default().right);
    }
    assert!(most > 1.9 && most <= 2.0, "{most}");

    let unlimited = Params::<f32>::paper().validate().unwrap();
    let queue = Box::leak(Box::new(
        controller_core::queue::ReferenceQueue::<f32, 4>::new(),
    ));
    let settings = Settings::default().validate().unwrap();
    let task = ControlTask::new(
        MockDrive::<8>::new(1.0),
        queue.split().1,
        settings,
        unlimited,
    );
    assert_eq!(task.err(), Some(SettingError::TorqueLimit));
}
