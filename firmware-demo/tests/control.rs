//! The control task on missions without faults.

use crate::rig::{MAX_TORQUE, Rig, params};
use controller_core::maths::Single;
use controller_core::queue::TimedReference;
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::safety::Fault;
use controller_core::safety::Timeout;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::types::{Accel, Pose, Twist};
use firmware_demo::control::{ControlTask, SettingError};
use firmware_demo::drive::{Call, MockDrive};
use protocol::{Command, RejectReason};

#[test]
fn complete_trajectory_ends_parked_at_its_last_reference() {
    let mut rig = Rig::at(Pose::new(-0.05, 0.02, 0.0));
    rig.run(10);
    assert_eq!(rig.is(), (State::Idle, Cause::PowerOn));
    rig.command(Command::Arm).unwrap();
    rig.run(10);
    assert_eq!(
        rig.task.applied(),
        Some(Default::default()),
        "armed: zero torque"
    );
    rig.line(40, true);
    rig.tick();
    assert_eq!(rig.is(), (State::Tracking, Cause::References));
    let tracked = rig.run_until(5000, |rig| rig.task.state() == State::Parking);
    // It hands over before the end of its 3.9 s, and not before the last two samples are near.
    assert!((3699..=3901).contains(&tracked), "{tracked}");
    assert_eq!(rig.task.cause(), Cause::TrajectoryEnded);
    rig.run_until(8000, |rig| rig.task.state() == State::Parked);
    assert_eq!(rig.task.cause(), Cause::Reached);
    rig.run(2000);
    assert_eq!(rig.task.state(), State::Parked, "and stays");
    let pose = rig.model.measured().pose;
    // The tolerance of arrival is half a millimetre, that of encoders of 0.3 mm a count some counts more.
    let off = (pose.x - 1.56).hypot(pose.y);
    assert!(off < 0.003, "{pose:?}");
}

#[test]
fn underrun_ends_in_a_smooth_stop_that_does_not_back_up() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.line(20, false);
    let stopping = State::Stopping(Then::Stopped);
    let tracked = rig.run_until(2500, |rig| rig.task.state() == stopping);
    // 1.9 s of samples, and 100 ms for more of them to come.
    assert!((1995..=2005).contains(&tracked), "{tracked}");
    assert_eq!(rig.task.cause(), Cause::Fault(Fault::CommandStale));
    let start = rig.model.measured().pose.x;
    let (mut slowest, mut hardest) = (f32::MAX, 0.0_f32);
    let mut before = rig.speed();
    let ticks = rig.run_until(5000, |rig| {
        slowest = slowest.min(rig.speed());
        hardest = hardest.max((rig.speed() - before).abs());
        before = rig.speed();
        rig.task.state() == State::Stopped
    });
    assert_eq!(rig.task.drive_mut().output(), Call::Release);
    // Back by less than 1 cm/s, which counts as standing. The limit of 1.5 m/s^2, and as much again for the loop's own error.
    assert!(slowest > -0.01, "{slowest}");
    assert!(hardest < 3.0e-3, "{hardest}");
    assert!(ticks < 1500, "{ticks}");
    let way = rig.model.measured().pose.x - start;
    // v²/(2a) = 5 cm, and what jerk and loop add.
    assert!((0.04..0.15).contains(&way), "{way}");
}

#[test]
fn samples_that_come_late_are_followed_on() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.line(11, false);
    rig.run(1050);
    assert_eq!(
        rig.task.state(),
        State::Tracking,
        "50 ms without a reference"
    );
    let line = ConstantTwist {
        start: Pose::default(),
        twist: Twist::new(0.4, 0.0),
    };
    for number in 11..20_u8 {
        let t = f32::from(number) * 0.1;
        let reference = line.at::<Single>(t);
        let sample = TimedReference { t, reference };
        rig.references.push(sample).unwrap();
    }
    rig.run(700);
    assert_eq!(rig.task.state(), State::Tracking);
    // On its reference again, at 1.75 s on the clock of the trajectory, but for what is left of the start from standstill. A
    // clock that had stood for the 50 ms would be another 2 cm behind.
    let error = rig.task.report().motion.unwrap().error;
    assert!(error.x.abs() < 0.04, "{error:?}");
}

/// Along x from rest to rest, a meter in four seconds, the robot 30 mm beside it all along.
fn drive_beside_the_path(knows_its_end: bool) -> f32 {
    let mut rig = Rig::at(Pose::new(0.0, 0.03, 0.0));
    rig.command(Command::Arm).unwrap();
    for number in 0..41_u8 {
        let t = f32::from(number) * 0.1;
        let rest = 4.0 - t;
        let (x, v, a) = if t < 2.0 {
            (0.125 * t * t, 0.25 * t, 0.25)
        } else {
            (1.0 - 0.125 * rest * rest, 0.25 * rest, -0.25)
        };
        let left = if knows_its_end { 1.0 - x } else { 0.0 };
        let reference = Reference::new(
            Pose::new(x, 0.0, 0.0),
            Twist::new(v, 0.0),
            Accel::new(a, 0.0),
        );
        let reference = reference.with_left(left);
        rig.references
            .push(TimedReference { t, reference })
            .unwrap();
    }
    rig.run(3_990);
    assert_eq!(rig.task.state(), State::Tracking);
    rig.model.measured().pose.y
}

/// References that say what is left of their path bring a robot that is beside it to its end: to 0.01 mm, where feedback leaves 0.24.
#[test]
fn references_that_know_their_end_lead_to_it() {
    let [followed, led] = [false, true].map(drive_beside_the_path);
    println!("{followed} {led}");
    assert!(
        led.abs() < 0.5e-3 && followed.abs() > 4.0 * led.abs(),
        "{followed} {led}"
    );
}

#[test]
fn parks_from_standstill_and_changes_its_goal_on_the_way() {
    let mut rig = Rig::new();
    assert_eq!(rig.park(1.0, 0.0, 0.0), Err(RejectReason::State));
    rig.command(Command::Arm).unwrap();
    // No pose, and one where nobody parks: such a torque would be infinite, and a fault.
    for x in [f32::NAN, 1.1e6, -1.0e12] {
        assert_eq!(rig.park(x, 0.0, 0.0), Err(RejectReason::Value));
        assert_eq!(rig.park(0.0, x, 0.0), Err(RejectReason::Value));
    }
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
    assert!((rig.model.measured().pose.x - 2.0).abs() < 0.003);
    rig.park(1.5, 0.0, 0.0).unwrap();
    rig.tick();
    assert_eq!(rig.task.state(), State::Parking);
    rig.run_until(15_000, |rig| rig.task.state() == State::Parked);
    assert!((rig.model.measured().pose.x - 1.5).abs() < 0.003);
}

#[test]
fn leaves_a_trajectory_for_a_goal_without_a_torque_step() {
    let mut rig = Rig::tracking();
    let before = rig.task.applied().unwrap();
    rig.park(1.5, 0.0, 0.0).unwrap();
    rig.tick();
    assert_eq!(rig.is(), (State::Parking, Cause::Host));
    assert!(rig.task.report().motion.unwrap().jumped);
    let after = rig.task.applied().unwrap();
    // L dt of the law's guarantee is 1 % of the limit in a tick of 1 ms.
    assert!((after.right - before.right).abs() < 0.02 * MAX_TORQUE);
    rig.run_until(15_000, |rig| rig.task.state() == State::Parked);
}

#[test]
fn stops_on_request_and_runs_the_next_trajectory() {
    let mut rig = Rig::tracking();
    rig.command(Command::Stop).unwrap();
    rig.tick();
    assert_eq!(rig.is(), (State::Stopping(Then::Stopped), Cause::Host));
    assert!(
        rig.task.applied().is_some(),
        "within the limits, by the law"
    );
    assert_eq!(rig.command(Command::Arm), Err(RejectReason::State));
    rig.run_until(2000, |rig| rig.task.state() == State::Stopped);
    assert_eq!(rig.task.drive_mut().output(), Call::Release);
    assert!(rig.speed().abs() < 0.02);
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
fn silent_host_begins_a_stop_within_100_ms() {
    for parks in [false, true] {
        let mut rig = if parks {
            Rig::parking()
        } else {
            Rig::tracking()
        };
        rig.command(Command::Heartbeat).unwrap();
        rig.host_alive = false;
        let stopping = State::Stopping(Then::Stopped);
        let ticks = rig.run_until(200, |rig| rig.task.state() == stopping);
        assert!((90..=100).contains(&ticks), "{ticks}");
        assert_eq!(rig.task.cause(), Cause::LinkLost);
        rig.run_until(2000, |rig| rig.task.state() == State::Stopped);
        // A host that comes back has to arm.
        rig.host_alive = true;
        rig.line(10, false);
        rig.run(50);
        assert_eq!(rig.task.state(), State::Stopped);
    }
}

#[test]
fn the_link_is_not_watched_only_when_told_so() {
    assert!(matches!(
        params().detectors.command,
        Timeout::AfterUs(100_000)
    ));
    let mut free = params();
    free.detectors.command = Timeout::Off;
    let mut rig = Rig::with(free, Pose::default());
    rig.host_alive = false;
    rig.command(Command::Arm).unwrap();
    rig.park(0.5, 0.0, 0.0).unwrap();
    rig.run_until(8000, |rig| rig.task.state() == State::Parked);
    free.detectors.command = Timeout::AfterUs(0);
    let queue = Box::leak(Box::new(
        controller_core::queue::ReferenceQueue::<f32, 4>::new(),
    ));
    let task = ControlTask::new(
        MockDrive::<8>::new(MAX_TORQUE),
        queue.split().1,
        free,
        Pose::default(),
    );
    assert!(matches!(task.err(), Some(SettingError::Base(_))));
}

#[test]
fn the_button_reaches_the_wheels_in_the_same_call() {
    for (brake, call) in [(true, Call::Brake), (false, Call::Release)] {
        for mut rig in [Rig::tracking(), Rig::parking(), Rig::new()] {
            rig.command(Command::EmergencyStop { brake }).unwrap();
            assert_eq!(rig.task.drive_mut().output(), call, "before any tick");
            rig.tick();
            assert_eq!(rig.task.drive_mut().output(), call);
            assert_eq!(rig.task.cause(), Cause::EmergencyStop);
            rig.run_until(6000, |rig| rig.task.state() == State::Fault);
            assert_eq!(rig.command(Command::Arm), Err(RejectReason::State));
            assert_eq!(rig.task.drive_mut().output(), call, "until the reset");
            rig.command(Command::ResetFault).unwrap();
            rig.tick();
            assert_eq!(rig.task.state(), State::Idle);
            assert_eq!(rig.task.drive_mut().output(), Call::Release);
            rig.command(Command::Arm).unwrap();
        }
    }
}
