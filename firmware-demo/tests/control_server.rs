//! Control task and line together, against hostile bytes and sensors: no panic, no torque beyond its limit, none
//! at all outside of the states that may have one, and back in step with the host at once.

use controller_core::base::Sensed;
use controller_core::gyro::GyroReading;
use controller_core::hal::{ErrorKind, WheelCounts};
use controller_core::localiser::Fix;
use controller_core::safety::Currents;
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use firmware_demo::control::ControlTask;
use firmware_demo::control_server::{CommandReceiver, ControlServer, Queues};
use firmware_demo::drive::MockDrive;
use firmware_demo::mission;
use firmware_demo::storage::{RamFlash, Slots};
use proptest::collection::vec;
use proptest::prelude::*;
use protocol::{
    Command, Frame, MAX_FRAME, Telemetry, TimedSample, WirePose, WireReference, WireTwist, encode,
};

const LIMIT: f32 = 3.0;

#[derive(Clone, Debug)]
enum Act {
    Bytes(Vec<u8>),
    Say(Command),
    Tick(u32, Sensed<f32>),
}

/// Mostly numbers a robot could meet, sometimes any bit pattern.
fn real() -> impl Strategy<Value = f32> {
    prop_oneof![9 => -2.0_f32..2.0, 1 => any::<u32>().prop_map(f32::from_bits)]
}

/// Counts of a robot near its start, sometimes of no robot at all, and everything else that can be sensed.
fn sensed() -> impl Strategy<Value = Sensed<f32>> {
    let count = || prop_oneof![9 => -200..200_i32, 1 => any::<i32>()];
    let counts = (count(), count(), 0_u8..20).prop_map(|(right, left, fails)| match fails {
        0 => Err(ErrorKind::Bus),
        _ => Ok(WheelCounts { right, left }),
    });
    (counts, vec(real(), 10), any::<[bool; 5]>()).prop_map(|(counts, v, has)| Sensed {
        counts,
        fix: has[0].then(|| Fix {
            pose: Pose::new(v[0], v[1], v[2]),
            age_s: v[3],
        }),
        gyro: has[3].then(|| GyroReading {
            rate: v[7],
            heading: has[4].then_some(v[8]),
            age_s: v[9],
        }),
        supply_v: has[1].then_some(v[4]),
        currents: has[2].then_some(Currents {
            right: v[5],
            left: v[6],
        }),
        driver: Ok(()),
    })
}

fn command() -> impl Strategy<Value = Command> {
    prop_oneof![
        Just(Command::Heartbeat),
        Just(Command::Arm),
        Just(Command::Stop),
        Just(Command::ResetFault),
        Just(Command::GetCounters),
        Just(Command::GetParameters),
        Just(Command::SaveParameters),
        Just(Command::LoadDefaults),
        any::<bool>().prop_map(|brake| Command::EmergencyStop { brake }),
        (real(), real(), real()).prop_map(|(x, y, theta)| Command::SetPose {
            pose: WirePose { x, y, theta },
        }),
        (real(), real(), real()).prop_map(|(x, theta, age_s)| Command::Fix {
            pose: WirePose { x, y: 0.0, theta },
            age_s,
        }),
        (real(), real(), real()).prop_map(|(x, y, theta)| Command::Park {
            goal: WirePose { x, y, theta },
        }),
        (real(), real(), any::<bool>()).prop_map(|(v, w, hold_heading)| Command::Drive {
            twist: WireTwist { v, w },
            hold_heading,
        }),
        (0_u8..20, real(), real()).prop_map(|(t, x, v)| {
            let mut reference = WireReference::default();
            (reference.pose.x, reference.twist.v) = (x, v);
            let t = f32::from(t) * 0.001;
            Command::Sample(TimedSample { t, reference })
        }),
    ]
}

fn act() -> impl Strategy<Value = Act> {
    prop_oneof![
        1 => vec(any::<u8>(), 0..40).prop_map(Act::Bytes),
        4 => command().prop_map(Act::Say),
        8 => (900_u32..1200, sensed()).prop_map(|(us, sensed)| Act::Tick(us, sensed)),
        1 => (0_u32..200_000, sensed()).prop_map(|(us, sensed)| Act::Tick(us, sensed)),
    ]
}

fn may_have_torque(state: State) -> bool {
    state.drives() || matches!(state, State::Armed | State::Parked | State::Stopping(_))
}

fn say(receiver: &mut CommandReceiver<'_>, command: &Command) -> Option<Frame<Telemetry>> {
    let mut frame = [0; MAX_FRAME];
    let frame = encode(7, command, &mut frame).expect("every command fits");
    frame.iter().find_map(|&byte| receiver.push(byte, || 0))
}

proptest! {
    #[test]
    fn nothing_makes_a_torque_that_should_not_be(acts in vec(act(), 1..300)) {
        let mut queues = Queues::default();
        let (references, ends, mut receiver) = queues.split(3);
        let task = ControlTask::new(
            MockDrive::<0>::new(LIMIT),
            references,
            mission::params(LIMIT, true).unwrap(),
            Pose::default(),
        )
        .unwrap();
        let mut server = ControlServer::with_memory(task, ends, Slots::new(RamFlash::default()));
        let mut now_us = 0_u32;
        for act in acts {
            match act {
                Act::Bytes(bytes) => {
                    for byte in bytes {
                        receiver.push(byte, || 0);
                    }
                }
                Act::Say(command) => {
                    say(&mut receiver, &command);
                }
                Act::Tick(elapsed_us, sensed) => {
                    now_us = now_us.wrapping_add(elapsed_us);
                    server.tick(now_us, &sensed);
                    let state = server.task().state();
                    if let Some(applied) = server.task().applied() {
                        prop_assert!(applied.right.abs() <= LIMIT && applied.left.abs() <= LIMIT);
                        prop_assert!(may_have_torque(state), "{:?}", state);
                    }
                    while receiver.pending().is_some() {}
                }
            }
        }
        // Two frames after whatever came before: the second one arrives.
        say(&mut receiver, &Command::Heartbeat);
        let hello = say(&mut receiver, &Command::Heartbeat);
        let hello = hello.map(|answer| answer.message);
        prop_assert!(matches!(hello, Some(Telemetry::Hello(_))), "{:?}", hello);
        // A stop is obeyed in the next tick, from every state.
        say(&mut receiver, &Command::Stop);
        server.tick(now_us.wrapping_add(1000), &Sensed::of_counts(WheelCounts::default()));
        let state = server.task().state();
        prop_assert!(
            matches!(state, State::Stopping(_) | State::Braking(_) | State::Stopped | State::Fault),
            "{:?}",
            state
        );
        // And the button takes every torque away.
        say(&mut receiver, &Command::EmergencyStop { brake: false });
        server.tick(now_us.wrapping_add(2000), &Sensed::of_counts(WheelCounts::default()));
        prop_assert_eq!(server.task().applied(), None);
        prop_assert_eq!(server.task().state(), State::Fault);
    }
}
