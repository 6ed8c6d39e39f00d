//! The line: bytes into a robot's receiver between its ticks, and into a host's decoder.

use controller_core::base::Sensed;
use controller_core::hal::WheelCounts;
use controller_core::types::Pose;
use firmware_demo::control::ControlTask;
use firmware_demo::control_server::{ControlServer, Queues};
use firmware_demo::drive::MockDrive;
use firmware_demo::mission;
use firmware_demo::storage::{RamFlash, Slots};
use protocol::{
    Command, Decoder, FieldParams, MAX_CONTENT, MAX_FRAME, Telemetry, WirePose, WireTwist, encode,
};

use super::engine::{Met, Target};

/// Largest torque of a wheel \[N m\].
const TORQUE: f32 = 15.0;

/// Bytes as they come; 0xA5 and a byte is so many ticks. What is decoded encodes to a frame that decodes to the same.
pub const LINE: Target = Target {
    name: "line",
    run: line,
    seeds,
    longest: 2_000,
    words: &["\0", "\u{A5}\u{5}", "\0\0"],
    in_a_test: 20_000,
};

/// A byte that stands for ticks and not for itself.
const TICKS: u8 = 0xA5;

fn seeds() -> Vec<Vec<u8>> {
    let goal = WirePose {
        x: 0.5,
        y: 0.2,
        theta: 1.0,
    };
    let twist = WireTwist { v: 0.3, w: -0.2 };
    let field = FieldParams::from(&mission::params(TORQUE, true).expect("valid"));
    let drive = Command::Drive {
        twist,
        hold_heading: true,
    };
    let fix = Command::Fix {
        pose: goal,
        age_s: 0.02,
    };
    let missions: [&[Command]; 5] = [
        &[
            Command::Heartbeat,
            Command::Arm,
            Command::Park { goal },
            Command::Stop,
        ],
        &[
            Command::Arm,
            drive,
            drive,
            Command::EmergencyStop { brake: true },
            Command::ResetFault,
        ],
        &[
            Command::SetParameters(field),
            Command::SaveParameters,
            Command::LoadDefaults,
        ],
        &[
            Command::SetPose { pose: goal },
            fix,
            Command::GetCounters,
            Command::GetParameters,
        ],
        &[
            Command::Arm,
            drive,
            Command::Park { goal },
            Command::EmergencyStop { brake: false },
        ],
    ];
    let mut frame = [0; MAX_FRAME];
    missions
        .iter()
        .map(|commands| {
            let mut bytes = Vec::new();
            for (sequence, command) in commands.iter().enumerate() {
                bytes.extend(encode(sequence as u16, command, &mut frame).expect("it fits"));
                bytes.extend([TICKS, 3]);
            }
            bytes
        })
        .collect()
}

fn line(input: &[u8], met: &mut Met) {
    both_ways(input, met);
    let mut queues = Queues::default();
    let (references, ends, mut receiver) = queues.split(1);
    let params = mission::params(TORQUE, true).expect("valid");
    let task = ControlTask::new(
        MockDrive::<0>::new(TORQUE),
        references,
        params,
        Pose::default(),
    )
    .expect("valid");
    let mut server = ControlServer::with_memory(task, ends, Slots::new(RamFlash::<256>::blank()));
    let mut now_us = 0_u32;
    let mut bytes = input.iter().copied();
    let mut before = None;
    while let Some(byte) = bytes.next() {
        if byte == TICKS {
            for _ in 0..=bytes.next().unwrap_or(0) % 32 {
                now_us = now_us.wrapping_add(mission::PERIOD_US);
                let counts = WheelCounts {
                    right: (now_us / 5_000) as i32,
                    left: (now_us / 6_000) as i32,
                };
                server.tick(now_us, &Sensed::of_counts(counts));
                let report = server.task().report();
                if let Some(torques) = report.action.torques() {
                    let within = |torque: f32| (-TORQUE..=TORQUE).contains(&torque);
                    assert!(within(torques.right) && within(torques.left), "{torques:?}");
                }
                met.saw((before, report.state));
                before = Some(report.state);
            }
        } else if let Some(answer) = receiver.push(byte, || now_us) {
            met.saw(std::mem::discriminant(&answer.message));
        }
        while let Some(answer) = receiver.pending() {
            met.saw(std::mem::discriminant(&answer.message));
        }
    }
}

/// What two decoders make of the bytes goes through an encoder and comes back.
fn both_ways(input: &[u8], met: &mut Met) {
    let mut commands = Decoder::<Command, MAX_CONTENT>::new();
    let mut telemetry = Decoder::<Telemetry, MAX_CONTENT>::new();
    let mut frame = [0; MAX_FRAME];
    for byte in input {
        match commands.push(*byte) {
            Some(Ok(found)) => {
                met.saw(std::mem::discriminant(&found.message));
                let again = encode(found.sequence, &found.message, &mut frame).expect("it fits");
                let mut decoder = Decoder::<Command, MAX_CONTENT>::new();
                let back = again.iter().find_map(|byte| decoder.push(*byte));
                // By what it prints, for NaN is not equal to itself.
                assert_eq!(
                    format!("{back:?}"),
                    format!("{:?}", Some(Ok::<_, ()>(found)))
                );
            }
            Some(Err(error)) => met.saw(format!("{error:?}")),
            None => {}
        }
        if let Some(Ok(found)) = telemetry.push(*byte) {
            met.saw(std::mem::discriminant(&found.message));
        }
    }
    let counters = commands.counters();
    let frames = input
        .split(|byte| *byte == 0)
        .filter(|frame| !frame.is_empty());
    assert!(counters.good + counters.rejected() <= frames.count() as u32);
}
