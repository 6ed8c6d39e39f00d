//! Fault scripts: each ends released, in the fault state, within the stated number of ticks, and stays there.

#[path = "support/rig.rs"]
mod rig;

use controller_core::hal::ErrorKind;
use controller_core::types::{Measured, Twist};
use firmware_demo::control::SensorFault;
use firmware_demo::drive::Script;
use firmware_demo::fault::{Cause, DriverFault, Fault};
use firmware_demo::protocol::{Command, Refusal, RejectReason};
use firmware_demo::supervisor::State;
use rig::{PERIOD_US, Rig};

/// Runs `tick` until the wheels are free: after exactly `expected` ticks, in `fault`, latched until reset.
fn ends(name: &str, fault: Fault, within: u32, mut rig: Rig, mut tick: impl FnMut(&mut Rig)) {
    let mut ticks = 0;
    while rig.task.state() != State::Fault {
        tick(&mut rig);
        ticks += 1;
        assert!(ticks <= within, "{name}: not within {within} ticks");
    }
    println!("{name}: {ticks} ticks");
    assert_eq!(rig.task.cause(), Cause::Fault(fault), "{name}");
    assert_eq!(rig.task.told(), None, "{name}");
    rig.task.drive_mut().fail(Script::default());
    for command in [Command::Arm, Command::Stop, Command::Heartbeat] {
        let _ = rig.command(command);
        rig.run(20);
        assert_eq!(rig.task.state(), State::Fault, "{name} is latched");
        assert_eq!(rig.task.drive_mut().told(), None, "{name}");
    }
    assert_eq!(rig.park(1.0, 0.0, 0.0), Err(RejectReason::State));
    assert_eq!(rig.command(Command::ResetFault), Ok(()));
    rig.run(5);
    assert_eq!(rig.task.state(), State::Idle, "{name}");
    assert_eq!(rig.command(Command::Arm), Ok(()));
}

#[test]
fn driver_error_releases_in_the_same_tick() {
    for (kind, fault) in [
        (ErrorKind::Bus, DriverFault::Bus),
        (ErrorKind::OverCurrent, DriverFault::OverCurrent),
        (ErrorKind::UnderVoltage, DriverFault::UnderVoltage),
    ] {
        let mut rig = Rig::tracking();
        let script = Script {
            from: 0,
            count: 1,
            kind: Some(kind),
        };
        rig.task.drive_mut().fail(script);
        ends("driver error", Fault::Driver(fault), 1, rig, Rig::tick);
    }
}

#[test]
fn release_is_tried_again_until_the_driver_obeys() {
    let mut rig = Rig::tracking();
    let script = Script {
        from: 0,
        count: 4,
        kind: None,
    };
    rig.task.drive_mut().fail(script);
    rig.tick();
    assert_eq!(rig.task.state(), State::Fault);
    assert!(
        rig.task.drive_mut().told().is_some(),
        "the driver did not obey"
    );
    rig.run(3);
    assert_eq!(rig.task.drive_mut().told(), None);
}

#[test]
fn pose_that_is_no_number_releases_in_the_same_tick() {
    for value in [f32::NAN, f32::INFINITY] {
        ends(
            "pose",
            Fault::Refused(Refusal::Pose),
            1,
            Rig::tracking(),
            |rig| {
                let mut measured = *rig.model.measured();
                measured.pose.y = value;
                rig.tick_with(PERIOD_US, Ok(measured));
            },
        );
    }
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.park(1.0, 0.0, 0.0).unwrap();
    ends("twist", Fault::Refused(Refusal::Twist), 1, rig, |rig| {
        let twist = Twist::new(f32::NAN, 0.0);
        rig.tick_with(
            PERIOD_US,
            Ok(Measured {
                twist,
                ..Measured::default()
            }),
        );
    });
}

#[test]
fn lost_sensor_releases_in_the_same_tick() {
    let rig = Rig::tracking();
    ends("sensor", Fault::Sensor, 1, rig, |rig| {
        rig.tick_with(PERIOD_US, Err(SensorFault));
    });
}

#[test]
fn overruns_in_a_row_release_and_single_ones_are_counted() {
    let mut rig = Rig::tracking();
    for _ in 0..10 {
        let measured = *rig.model.measured();
        rig.tick_with(1800, Ok(measured));
        rig.tick();
    }
    assert_eq!(
        (rig.task.state(), rig.task.overruns()),
        (State::Tracking, 10)
    );
    ends("overrun", Fault::Overrun, 5, rig, |rig| {
        let measured = *rig.model.measured();
        rig.tick_with(1800, Ok(measured));
    });
}

#[test]
fn one_gap_longer_than_the_silence_releases_at_once() {
    let mut rig = Rig::tracking();
    rig.task.heard();
    let measured = *rig.model.measured();
    rig.tick_with(600_000, Ok(measured));
    assert_eq!(rig.task.told(), None);
    assert_eq!(
        (rig.task.state(), rig.task.cause()),
        (State::Stopped, Cause::LinkLost)
    );
}

/// From the moment the torque passes the threshold of 0.5 N m it takes 250 ticks; the encoders freeze on a
/// robot in motion, so it first takes the loop a while to push that hard.
#[test]
fn stuck_encoder_releases_within_its_time() {
    let rig = Rig::tracking();
    let frozen = rig.model.measured().pose;
    ends(
        "both encoders stuck",
        Fault::EncoderStuck,
        300,
        rig,
        |rig| {
            let measured = Measured {
                pose: frozen,
                twist: Twist::default(),
            };
            rig.tick_with(PERIOD_US, Ok(measured));
        },
    );
    // One wheel: its share of speed and turn is missing.
    ends(
        "right encoder stuck",
        Fault::EncoderStuck,
        600,
        Rig::tracking(),
        |rig| {
            let Measured { pose, twist } = *rig.model.measured();
            let left = twist.linear - 0.25 * twist.angular;
            let twist = Twist::new(0.5 * left, -left / 0.5);
            rig.tick_with(PERIOD_US, Ok(Measured { pose, twist }));
        },
    );
}

#[test]
fn lost_host_releases_within_100_ticks() {
    let mut rig = Rig::tracking();
    rig.host_alive = false;
    let ticks = rig.run_until(101, |rig| rig.task.told().is_none());
    assert!(ticks <= 100, "{ticks}");
    assert_eq!(
        (rig.task.state(), rig.task.cause()),
        (State::Stopped, Cause::LinkLost)
    );
}
