//! Every kind of fault on the task: in the tick in which it is found the output is what the policy says, and what latches stays
//! until it is reset.

use crate::reaches::{moving, reaches, with};
use crate::rig::{MAX_TORQUE, PERIOD_US, Rig, body};
use controller_core::hal::{ErrorKind, WheelCounts};
use controller_core::localiser::Fix;
use controller_core::queue::TimedReference;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{State, Then};
use controller_core::safety::{FaultKind, Timeout};
use controller_core::types::{Accel, Measured, Pose, Twist};
use firmware_demo::drive::Call;
use firmware_demo::mission;
use firmware_demo::model::Model;
use protocol::{Command, RejectReason};

#[test]
fn lost_encoders_brake_after_five_ticks() {
    reaches(FaultKind::MeasurementStale, 5, Rig::tracking(), |rig, _| {
        rig.tick_with(PERIOD_US, |sensed| sensed.counts = Err(ErrorKind::Bus));
    });
    // Four ticks without them are bridged.
    let mut rig = Rig::tracking();
    for _ in 0..4 {
        rig.tick_with(PERIOD_US, |sensed| sensed.counts = Err(ErrorKind::Bus));
        assert!(rig.task.report().blind);
    }
    rig.run(100);
    assert_eq!(rig.task.state(), State::Tracking);
}

#[test]
fn missing_fixes_stop() {
    let mut rig = Rig::with(mission::params(MAX_TORQUE, true).unwrap(), Pose::default());
    let fix = |pose| Fix { pose, age_s: 0.0 };
    rig.tick_with(PERIOD_US, |_| {});
    for tick in 0..100 {
        let pose = rig.model.measured().pose;
        rig.tick_with(PERIOD_US, |sensed| {
            sensed.fix = (tick % 50 == 0).then_some(fix(pose));
        });
    }
    rig.command(Command::Arm).unwrap();
    rig.park(4.0, 0.0, 0.0).unwrap();
    reaches(FaultKind::PoseStale, 1001, rig, |rig, _| rig.tick());
}

#[test]
fn references_that_run_dry_stop() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.line(10, false);
    reaches(FaultKind::CommandStale, 1010, rig, |rig, _| rig.tick());
}

/// Two finite samples whose interpolation is not: the queue takes them, the law does not.
#[test]
fn references_that_overflow_brake() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.line(5, false);
    for (t, x) in [(0.5, 3.0e38), (0.6, -3.0e38)] {
        let pose = Pose::new(x, 0.0, 0.0);
        let reference = Reference::new(pose, Twist::new(0.4, 0.0), Accel::default());
        rig.references
            .push(TimedReference { t, reference })
            .unwrap();
    }
    rig.run(1);
    let mut found = None;
    for _ in 0..600 {
        rig.tick();
        found = rig.task.report().active_faults.iter().next();
        if found.is_some() {
            break;
        }
    }
    assert_eq!(found.unwrap().kind(), FaultKind::NotFinite);
    assert_eq!(rig.task.drive_mut().output(), Call::Brake);
    assert_eq!(rig.task.state(), State::Braking(Then::Fault));
}

#[test]
fn uneven_ticks_stop_and_single_late_ones_are_counted() {
    let mut rig = Rig::tracking();
    for _ in 0..10 {
        rig.tick_with(1800, |_| {});
        for _ in 0..9 {
            rig.tick();
        }
    }
    assert_eq!(
        (rig.task.state(), rig.task.overruns()),
        (State::Tracking, 10)
    );
    reaches(FaultKind::TickJitter, 5, rig, |rig, _| {
        rig.tick_with(1800, |_| {});
    });
}

#[test]
fn one_long_tick_stops() {
    reaches(FaultKind::TickTooLong, 1, Rig::tracking(), |rig, _| {
        rig.tick_with(60_000, |_| {});
    });
    // So does one beyond what the law steps over, in that tick: the wheels are not let go in between.
    let mut rig = Rig::tracking();
    rig.tick_with(600_000, |_| {});
    assert_eq!(rig.task.state(), State::Stopping(Then::Fault));
    for _ in 0..10 {
        assert!(rig.task.applied().is_some());
        assert_ne!(rig.task.drive_mut().output(), Call::Release);
        rig.tick();
    }
}

#[test]
fn jump_of_the_pose_is_ignored() {
    let fused = Rig::with(mission::params(MAX_TORQUE, true).unwrap(), Pose::default());
    let fix = |rig: &mut Rig, aside: f32| {
        let mut pose = rig.model.measured().pose;
        pose.y += aside;
        rig.tick_with(PERIOD_US, |sensed| {
            sensed.fix = Some(Fix { pose, age_s: 0.0 });
        });
    };
    let mut rig = moving(fused);
    for _ in 0..100 {
        fix(&mut rig, 0.0);
    }
    // So many as have to agree.
    reaches(FaultKind::PoseJump, 10, rig, |rig, _| fix(rig, 1.0));
}

/// 250 ms after the torque has passed what turns a free wheel: from standstill, where nothing else is to be seen.
#[test]
fn stuck_encoders_brake() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.tick();
    rig.line(60, false);
    let stands = WheelCounts::default();
    reaches(FaultKind::EncoderStuck, 600, rig, |rig, _| {
        rig.tick_with(PERIOD_US, |sensed| sensed.counts = Ok(stands));
    });
    // Of a robot in motion encoders that freeze look as if it were braking against its torque: found all the same.
    for both in [true, false] {
        let mut rig = Rig::tracking();
        let frozen = rig.counts;
        let mut ticks = 0;
        while rig.task.state() == State::Tracking {
            rig.tick_with(PERIOD_US, |sensed| {
                let left = sensed.counts.unwrap().left;
                sensed.counts = Ok(WheelCounts {
                    right: frozen.right,
                    left: if both { frozen.left } else { left },
                });
            });
            ticks += 1;
            assert!(ticks < 4000);
        }
        println!("both {both}: {ticks} ticks, {:?}", rig.is());
        assert_eq!(rig.task.drive_mut().output(), Call::Brake);
    }
}

#[test]
fn reversed_encoder_brakes() {
    let mut rig = Rig::new();
    rig.command(Command::Arm).unwrap();
    rig.park(4.0, 0.0, 0.0).unwrap();
    reaches(FaultKind::EncoderReversed, 1000, rig, |rig, _| {
        rig.tick_with(PERIOD_US, |sensed| {
            let counts = sensed.counts.unwrap();
            sensed.counts = Ok(WheelCounts {
                right: -counts.right,
                left: -counts.left,
            });
        });
    });
}

#[test]
fn slipping_wheel_stops() {
    let rig = moving(Rig::new());
    reaches(FaultKind::WheelSlip, 400, rig, |rig, tick| {
        // 200 rad/s²: six times what is left to explain.
        let t = tick as f32 * 1.0e-3;
        let extra = 100.0 * t * t * (2048.0 / core::f32::consts::TAU);
        rig.tick_with(PERIOD_US, |sensed| {
            let WheelCounts { right, left } = sensed.counts.unwrap();
            sensed.counts = Ok(WheelCounts {
                right,
                left: left + extra as i32,
            });
        });
    });
}

/// It is refused where it comes in, and the base goes on to the goal that it has.
#[test]
fn goal_beyond_all_numbers_is_refused() {
    let mut rig = Rig::parking();
    let before = rig.task.state();
    assert_eq!(rig.park(3.0e38, 3.0e38, 0.0), Err(RejectReason::Value));
    rig.run(10);
    assert_eq!((rig.task.state(), before), (State::Parking, State::Parking));
}

/// Against a wall, with the detector of encoders off, which would be faster: 2 s.
#[test]
fn wall_stops() {
    let rig = with(|params| {
        params.detectors.wheels.stuck.after = Timeout::Off;
        params.detectors.wheels.reversed = Timeout::Off;
    });
    let there = rig.counts;
    let at_wall = Measured {
        pose: rig.model.measured().pose,
        ..Measured::default()
    };
    reaches(FaultKind::Stalled, 4000, rig, |rig, _| {
        rig.model = Model::new(body(), at_wall);
        rig.tick_with(PERIOD_US, |sensed| sensed.counts = Ok(there));
    });
}

/// A tolerance that encoders of 0.3 mm a count cannot meet, and no second try.
#[test]
fn goal_out_of_reach_stops() {
    let mut rig = with(|params| {
        params.motion.arrival.distance_m = 1.0e-5;
        params.motion.arrival.heading_rad = 1.0e-5;
        params.motion.arrival.retries = 0;
    });
    // Aside, where no whole number of counts leads to within that; straight ahead one does.
    rig.park(4.0, 0.3, 0.0).unwrap();
    reaches(FaultKind::GoalUnreachable, 60_000, rig, |rig, _| rig.tick());
}
