//! Control task and line together, against hostile bytes and sensors: no panic, no torque beyond its limit, none
//! at all outside of the states that may have one, and back in step with the host at once.

use controller_core::params::Params;
use controller_core::types::{Measured, Pose, Twist};
use firmware_demo::control::{ControlTask, SensorFault, Settings};
use firmware_demo::drive::MockDrive;
use firmware_demo::protocol::{
    Command, Frame, MAX_FRAME, Telemetry, TimedSample, WirePose, WireReference, encode,
};
use firmware_demo::station::{Queues, Reception, Station};
use firmware_demo::supervisor::State;
use proptest::collection::vec;
use proptest::prelude::*;

const LIMIT: f32 = 3.0;

#[derive(Clone, Debug)]
enum Act {
    Bytes(Vec<u8>),
    Say(Command),
    Tick(u32, Result<Measured<f32>, SensorFault>),
}

/// Mostly numbers a robot could meet, sometimes any bit pattern.
fn real() -> impl Strategy<Value = f32> {
    prop_oneof![9 => -2.0_f32..2.0, 1 => any::<u32>().prop_map(f32::from_bits)]
}

fn measured() -> impl Strategy<Value = Measured<f32>> {
    vec(real(), 5).prop_map(|v| Measured {
        pose: Pose::new(v[0], v[1], v[2]),
        twist: Twist::new(v[3], v[4]),
    })
}

fn command() -> impl Strategy<Value = Command> {
    prop_oneof![
        Just(Command::Heartbeat),
        Just(Command::Arm),
        Just(Command::Stop),
        Just(Command::ResetFault),
        Just(Command::GetCounters),
        (real(), real(), real()).prop_map(|(x, y, theta)| Command::Park {
            goal: WirePose { x, y, theta },
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
        8 => (900_u32..1200, measured()).prop_map(|(us, measured)| Act::Tick(us, Ok(measured))),
        1 => (0_u32..200_000, measured()).prop_map(|(us, measured)| Act::Tick(us, Ok(measured))),
        1 => Just(Act::Tick(1000, Err(SensorFault))),
    ]
}

fn say(reception: &mut Reception<'_>, command: &Command) -> Option<Frame<Telemetry>> {
    let mut frame = [0; MAX_FRAME];
    let frame = encode(7, command, &mut frame).expect("every command fits");
    frame.iter().find_map(|&byte| reception.push(byte, || 0))
}

proptest! {
    #[test]
    fn nothing_makes_a_torque_that_should_not_be(acts in vec(act(), 1..300)) {
        let mut params = Params::paper();
        params.max_wheel_torque_nm = Some(LIMIT);
        let mut queues = Queues::default();
        let (references, ends, mut reception) = queues.split(3);
        let task = ControlTask::new(
            MockDrive::<0>::new(LIMIT),
            references,
            Settings::default().validate().unwrap(),
            params.validate().unwrap(),
        )
        .unwrap();
        let mut station = Station::new(task, ends);
        let mut now_us = 0_u32;
        for act in acts {
            match act {
                Act::Bytes(bytes) => {
                    for byte in bytes {
                        reception.push(byte, || 0);
                    }
                }
                Act::Say(command) => {
                    say(&mut reception, &command);
                }
                Act::Tick(elapsed_us, sensed) => {
                    now_us = now_us.wrapping_add(elapsed_us);
                    station.tick(now_us, sensed);
                    let state = station.task().state();
                    if let Some(told) = station.task().told() {
                        prop_assert!(told.right.abs() <= LIMIT && told.left.abs() <= LIMIT);
                        prop_assert!(state == State::Armed || state.drives(), "{:?}", state);
                    }
                    while reception.pending().is_some() {}
                }
            }
        }
        // Two frames after whatever came before: the second one arrives.
        say(&mut reception, &Command::Heartbeat);
        let hello = say(&mut reception, &Command::Heartbeat);
        let hello = hello.map(|answer| answer.message);
        prop_assert!(matches!(hello, Some(Telemetry::Hello(_))), "{:?}", hello);
        // And a stop is obeyed in the next tick, from every state.
        say(&mut reception, &Command::Stop);
        station.tick(now_us.wrapping_add(1000), Ok(Measured::default()));
        prop_assert_eq!(station.task().told(), None);
        prop_assert!(matches!(station.task().state(), State::Stopped | State::Fault));
    }
}
