//! The control task that drives by velocity.

use crate::rig::{PERIOD_US, Rig, params};
use controller_core::base::{Sensed, WheelAction};
use controller_core::hal::{BySpeed, ErrorKind, WheelCounts};
use controller_core::motion::Mode;
use controller_core::motor::{DriverParams, SpeedParams};
use controller_core::queue::ReferenceQueue;
use controller_core::safety::Fault;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::types::{Pose, WheelSpeeds};
use firmware_demo::control::ControlTask;
use firmware_demo::drive::{DriveOutput as _, MockSpeedDrive, Script};
use protocol::pil::WheelOutput;
use protocol::{Command, RejectReason, WireTwist, tick_flags};

fn drive(v: f32, w: f32) -> Command {
    Command::Drive {
        twist: WireTwist { v, w },
        hold_heading: false,
    }
}

/// For so many ticks, an order in every 50th.
fn driven(rig: &mut Rig, ticks: u32, order: &Command) {
    for tick in 0..ticks {
        if tick % 50 == 0 {
            rig.command(*order).unwrap();
        }
        rig.tick();
    }
}

#[test]
fn an_armed_base_drives_as_ordered_and_says_so() {
    let mut rig = Rig::new();
    assert_eq!(rig.command(drive(0.2, 0.0)), Err(RejectReason::State));
    rig.command(Command::Arm).unwrap();
    driven(&mut rig, 1500, &drive(0.2, 0.1));
    assert_eq!(rig.is(), (State::Tracking, Cause::Host));
    let twist = rig.model.measured().twist;
    assert!((twist.linear - 0.2).abs() < 0.004, "{twist:?}");
    assert!((twist.angular - 0.1).abs() < 0.004, "{twist:?}");
    let flags = rig.task.telemetry().flags;
    assert_ne!(flags & tick_flags::DRIVING, 0);
    assert_eq!(flags & tick_flags::PARKING, 0);
    driven(&mut rig, 1500, &drive(0.0, 0.0));
    assert!(rig.speed().abs() < 0.002, "{}", rig.speed());
    assert_eq!(
        rig.task.state(),
        State::Tracking,
        "it waits for the next order"
    );
}

#[test]
fn stale_orders_stop_the_base_within_the_timeout() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    driven(&mut rig, 1451, &drive(0.3, 0.0));
    // The host is there, its heartbeats come; the last order is a tick old.
    let stopping = State::Stopping(Then::Stopped);
    let after = rig.run_until(200, |rig| rig.task.state() == stopping);
    assert!((95..=101).contains(&after), "{after}");
    assert_eq!(rig.task.cause(), Cause::Fault(Fault::CommandStale));
    assert_eq!(rig.command(drive(0.3, 0.0)), Err(RejectReason::State));
    rig.run_until(3000, |rig| rig.task.state() == State::Stopped);
    assert_eq!(rig.command(drive(0.3, 0.0)), Err(RejectReason::State));
    rig.command(Command::Arm).unwrap();
    driven(&mut rig, 1000, &drive(0.1, 0.0));
    assert_eq!(rig.task.state(), State::Tracking);
}

#[test]
fn what_is_no_order_is_refused_and_changes_nothing() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    driven(&mut rig, 500, &drive(0.2, 0.0));
    let before = rig.task.state();
    for (v, w) in [
        (f32::NAN, 0.0),
        (0.0, f32::INFINITY),
        (101.0, 0.0),
        (0.0, -101.0),
    ] {
        assert_eq!(rig.command(drive(v, w)), Err(RejectReason::Value));
        assert_eq!(rig.task.state(), before);
    }
    // Beyond what this base can, and within what any can: at the limit.
    driven(&mut rig, 4000, &drive(50.0, 0.0));
    let limit = rig.task.params().motion.limits.speed;
    assert!(
        (rig.speed() - limit).abs() < 0.02 * limit,
        "{}",
        rig.speed()
    );
    assert_ne!(rig.task.telemetry().flags & tick_flags::SPEED_LIMITED, 0);
}

#[test]
fn an_operator_takes_over_from_a_route_and_from_parking() {
    let mut rig = Rig::tracking();
    driven(&mut rig, 500, &drive(-0.1, 0.0));
    assert_eq!(rig.task.report().motion.unwrap().mode, Mode::Driving);
    // Nothing of the route is left: it does not go on by itself.
    rig.run(50);
    assert_eq!(rig.task.report().motion.unwrap().mode, Mode::Driving);
    rig.park(0.0, 0.0, 0.0).unwrap();
    rig.tick();
    assert_eq!(rig.task.state(), State::Parking);
    let mut rig = Rig::parking();
    driven(&mut rig, 300, &drive(0.0, 0.4));
    assert_eq!(rig.is(), (State::Tracking, Cause::Host));
    rig.park(0.5, 0.0, 0.0).unwrap();
    rig.run_until(30_000, |rig| rig.task.state() == State::Parked);
    // A base that is parked drives on without being armed again.
    driven(&mut rig, 100, &drive(0.1, 0.0));
    assert_eq!(rig.task.state(), State::Tracking);
}

#[test]
fn a_stop_beside_an_order_prevails() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    driven(&mut rig, 1000, &drive(0.3, 0.0));
    rig.command(drive(0.3, 0.0)).unwrap();
    rig.command(Command::Stop).unwrap();
    assert_eq!(rig.command(drive(0.3, 0.0)), Err(RejectReason::State));
    rig.tick();
    assert_eq!(rig.is(), (State::Stopping(Then::Stopped), Cause::Host));
}

/// Drivers that close their own speed loop, behind the same task: they get the speeds that the base desires, none before it drives, and are let go when
/// they fail.
#[test]
fn speed_drives_get_what_the_base_desires() {
    let speeds = SpeedParams {
        max_speed_rad_s: 30.0,
        min_speed_rad_s: 0.0,
        lag_s: 0.02,
        breakaway_nm: 0.0,
    };
    let mut params = params();
    params.driver = DriverParams::Speeds(speeds);
    params.detectors.wheels.stuck.torque_nm = 0.0;
    let mut queue = ReferenceQueue::<f32, 2>::new();
    let wheels = BySpeed::new(MockSpeedDrive::<8>::new(30.0));
    let mut task = ControlTask::new(wheels, queue.split().1, params, Pose::default()).unwrap();
    let mut now_us = 0;
    let mut tick = |task: &mut ControlTask<'_, BySpeed<MockSpeedDrive>>| {
        now_us += PERIOD_US;
        task.tick(now_us, &Sensed::of_counts(WheelCounts::default()));
        *task.output()
    };
    tick(&mut task);
    task.command(&Command::Arm).unwrap();
    assert_eq!(tick(&mut task), WheelAction::Release);
    assert_eq!(task.drive().drive().sets(), 0);
    task.command(&drive(0.2, 0.1)).unwrap();
    for _ in 0..50 {
        let WheelAction::Drive(command) = tick(&mut task) else {
            panic!("{:?}", task.report());
        };
        assert_eq!(task.drive().drive().applied(), Some(command.desired));
        let WheelSpeeds { right, left } = command.desired;
        assert_eq!(task.drive().output(), WheelOutput::Speed { right, left });
    }
    let applied = task.drive().drive().applied().unwrap();
    assert!(applied.right > applied.left && applied.left > 0.0);
    task.drive_mut().drive_mut().fail(Script {
        from: 0,
        count: 1,
        kind: Some(ErrorKind::OverCurrent),
    });
    assert_eq!(tick(&mut task), WheelAction::Release);
    assert_eq!(task.drive().drive().applied(), None);
    assert_eq!(task.drive().output(), WheelOutput::Release);
    tick(&mut task);
    let fault = Fault::Driver(ErrorKind::OverCurrent);
    assert_eq!(task.cause(), Cause::Fault(fault));
}
