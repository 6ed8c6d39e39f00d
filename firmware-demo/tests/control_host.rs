//! What a host and a driver report to the control task besides missions: parameters, poses, the supply.

use crate::rig::{MAX_TORQUE, PERIOD_US, Rig, params};
use controller_core::base::WheelAction;
use controller_core::localiser::FixOutcome;
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use firmware_demo::control::{ControlTask, SettingError};
use firmware_demo::drive::MockDrive;
use firmware_demo::mission;
use protocol::{Command, FieldParams, RejectReason, WirePose};

#[test]
fn parameters_change_while_disarmed_only_and_within_the_driver() {
    let set = |limit| {
        let mut field = FieldParams::from(&params());
        field.limits.wheel_torque_nm = limit;
        Command::SetParameters(field)
    };
    let mut rig = Rig::new();
    assert_eq!(rig.command(set(2.0)), Ok(()));
    for wrong in [2.0 * MAX_TORQUE, -1.0, f32::NAN] {
        assert_eq!(rig.command(set(wrong)), Err(RejectReason::Value));
    }
    assert_eq!(rig.task.params().motion.limits.wheel_torque_nm, 2.0);
    rig.command(Command::Arm).unwrap();
    for command in [set(2.0), Command::LoadDefaults] {
        assert_eq!(rig.command(command), Err(RejectReason::State));
    }
    // The accepted limit is the one in force.
    rig.line(60, false);
    let mut most = 0.0_f32;
    for _ in 0..1500 {
        rig.tick();
        most = most.max(rig.task.applied().unwrap_or_default().right);
    }
    // Commands take three quarters of it; the rest is for what disturbs.
    assert!(most > 1.4 && most <= 2.0, "{most}");
    rig.command(Command::Stop).unwrap();
    rig.run_until(4000, |rig| rig.task.state() == State::Stopped);
    let pose = rig.task.report().measured.unwrap().pose;
    assert_eq!(rig.command(Command::LoadDefaults), Ok(()));
    assert_eq!(rig.task.params(), &params());
    rig.tick();
    assert_eq!(
        rig.task.report().measured.unwrap().pose,
        pose,
        "the same place"
    );
    assert_eq!(rig.task.state(), State::Stopped);

    let queue = Box::leak(Box::new(
        controller_core::queue::ReferenceQueue::<f32, 4>::new(),
    ));
    let task = ControlTask::new(
        MockDrive::<8>::new(1.0),
        queue.split().1,
        params(),
        Pose::default(),
    );
    assert_eq!(task.err(), Some(SettingError::TorqueLimit));
}

#[test]
fn a_pose_is_set_and_a_fix_fused_without_a_torque_step() {
    let mut rig = Rig::parking();
    let before = rig.task.applied().unwrap();
    let pose = WirePose {
        x: 1.0,
        y: 1.0,
        theta: 0.5,
    };
    rig.command(Command::SetPose { pose }).unwrap();
    let fix = Command::Fix { pose, age_s: 0.0 };
    assert_eq!(rig.command(fix), Err(RejectReason::Unsupported));
    rig.tick();
    let report = rig.task.report();
    // Who sets a pose knows that it is another one.
    assert!(report.active_faults.is_empty());
    assert!((report.measured.unwrap().pose.y - 1.0).abs() < 1.0e-3);
    assert_eq!(rig.task.controller().supervisor().ignored().0, 0);
    assert_eq!(rig.task.state(), State::Parking);
    let after = rig.task.applied().unwrap();
    assert!((after.right - before.right).abs() < 0.02 * MAX_TORQUE);

    let mut rig = Rig::with(mission::params(MAX_TORQUE, true).unwrap(), Pose::default());
    rig.run(100);
    let pose = WirePose {
        x: 2.0e-3,
        y: 0.0,
        theta: 0.0,
    };
    rig.command(Command::Fix { pose, age_s: 0.02 }).unwrap();
    rig.tick();
    assert_eq!(rig.task.report().fix, FixOutcome::Fused);
    rig.tick();
    assert_eq!(rig.task.report().fix, FixOutcome::Absent);
    let far = WirePose { x: 1.0e9, ..pose };
    let fix = Command::Fix {
        pose: far,
        age_s: 0.02,
    };
    assert_eq!(rig.command(fix), Err(RejectReason::Value));
    for age_s in [-1.0, f32::NAN] {
        let fix = Command::Fix { pose, age_s };
        assert_eq!(rig.command(fix), Err(RejectReason::Value));
    }
    rig.command(Command::Fix { pose, age_s: 9.0 }).unwrap();
    rig.tick();
    assert!(matches!(rig.task.report().fix, FixOutcome::Refused(_)));
}

/// A driver that says what it exerts is believed: the base's own estimate goes by it.
#[test]
fn torques_and_what_a_driver_needs_come_together() {
    let mut rig = Rig::tracking();
    rig.tick_with(PERIOD_US, |sensed| sensed.supply_v = Some(11.5));
    let WheelAction::Drive(drive) = *rig.task.output() else {
        panic!("tracking")
    };
    // 0.4 m/s on wheels of 0.1 m, and what catches up with the reference after the start.
    for speed in [drive.speeds.right, drive.desired.left] {
        assert!((speed - 4.5).abs() < 0.7, "{drive:?}");
    }
}
