//! No input panics, hangs, or comes out as a reference that is not finite.

use byteorder::LittleEndian;
use cdr_encoding::to_vec;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use proptest::prelude::*;
use sim_host::import::{Options, bag_poses, import};
use sim_host::ros::messages::{Header, JointState, Path, Pose, Quaternion, Stamped, Time, Vector};
use sim_host::ros::read::{Field, Messages};
use std::collections::BTreeMap;
use std::error::Error;
use std::io::Cursor;
use std::time::{Duration, Instant};
use tests::fixtures;

const SMALL: [&str; 10] = [
    "small_wpilib.json",
    "small_choreo.traj",
    "small_tum.txt",
    "small_table.csv",
    "pathweaver.path",
    "pathplanner.path",
    "choreo_swerve.traj",
    "choreo_2024.traj",
    "choreo_empty.traj",
    "table_sideways.csv",
];

/// What a file of a few kilobytes may take, with room for a busy machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// A finite reference, or a refusal that says something, in time.
fn survives(bytes: &[u8]) {
    let begin = Instant::now();
    match import(bytes, &Options::default()) {
        Ok(trajectory) => {
            for s in trajectory.samples() {
                let values = [s.t, s.x, s.y, s.theta, s.v, s.w, s.a, s.alpha];
                assert!(values.iter().all(|v| v.is_finite()), "{s:?}");
            }
            let close = trajectory.closeness();
            assert!(close.position_m < 0.01 && close.heading_rad < 0.03);
        }
        Err(refusal) => assert!(refusal.to_string().len() > 10),
    }
    assert!(begin.elapsed() < PATIENCE);
}

#[test]
fn every_truncation_gives_a_result_or_a_refusal() -> Result<(), Box<dyn Error>> {
    for name in SMALL {
        let bytes = fixtures::read(name)?;
        for end in 0..=bytes.len() {
            survives(bytes.get(..end).unwrap_or_default());
        }
    }
    Ok(())
}

#[test]
fn every_byte_flip_gives_a_result_or_a_refusal() -> Result<(), Box<dyn Error>> {
    for name in SMALL {
        let mut bytes = fixtures::read(name)?;
        for at in 0..bytes.len() {
            // Every other bit, and one of the characters that numbers and structure are made of.
            let flips = (at % 2..8).step_by(2).map(|bit| 1u8 << bit);
            let Some(&byte) = bytes.get(at) else { continue };
            let swaps = b"0-9e,]".iter().skip(at % 6).take(1).map(|new| new ^ byte);
            for flip in flips.chain(swaps) {
                if let Some(b) = bytes.get_mut(at) {
                    *b ^= flip;
                }
                survives(&bytes);
                if let Some(b) = bytes.get_mut(at) {
                    *b = byte;
                }
            }
        }
    }
    Ok(())
}

/// A bag of a few poses, a path and some joints; a chunk for every few messages.
fn bag(options: WriteOptions) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut bytes = Vec::new();
    let mut writer = Writer::with_options(Cursor::new(&mut bytes), options.chunk_size(Some(512)))?;
    let mut channel = |topic: &str, kind: &str| {
        let schema = writer.add_schema(kind, "ros2msg", b"fields")?;
        writer.add_channel(schema, topic, "cdr", &BTreeMap::new())
    };
    let poses = channel("/pose", "geometry_msgs/msg/PoseStamped")?;
    let path = channel("/path", "nav_msgs/msg/Path")?;
    let joints = channel("/joint_states", "sensor_msgs/msg/JointState")?;
    let mut put = |channel_id: u16, log_time: u64, mut message: Vec<u8>| {
        message.splice(0..0, [0, 1, 0, 0]);
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: log_time,
        };
        writer.write_to_known_channel(&header, &message)
    };
    let mut way = Vec::new();
    for n in 0..6_u32 {
        let ns = 1_000_000_000 + 100_000_000 * u64::from(n);
        let header = Header {
            stamp: Time::of_ns(ns),
            frame_id: "map".to_owned(),
        };
        let value = Pose {
            position: Vector {
                x: 0.01 * f64::from(n * n),
                ..Vector::default()
            },
            orientation: Quaternion::of_heading(0.0),
        };
        let pose = Stamped {
            header: header.clone(),
            value,
        };
        way.push(pose.clone());
        put(poses, ns, to_vec::<_, LittleEndian>(&pose)?)?;
        let state = JointState {
            header,
            name: ["r", "l"].map(str::to_owned).into(),
            position: vec![0.1, 0.2],
            ..JointState::default()
        };
        put(joints, ns, to_vec::<_, LittleEndian>(&state)?)?;
    }
    let path_of = Path {
        header: Header::default(),
        poses: way,
    };
    put(path, 2_000_000_000, to_vec::<_, LittleEndian>(&path_of)?)?;
    writer.finish()?;
    drop(writer);
    Ok(bytes)
}

/// With checksums a flip is found; without them it comes as far as the messages.
#[test]
fn every_byte_flip_of_a_bag_gives_a_result_or_a_refusal() -> Result<(), Box<dyn Error>> {
    let joints = ["r", "l"].map(str::to_owned);
    for compression in [Some(Compression::Zstd), None] {
        for checked in [true, false] {
            let options = WriteOptions::new().compression(compression);
            let options = options
                .calculate_chunk_crcs(checked)
                .calculate_data_section_crc(checked);
            let mut bytes = bag(options)?;
            let whole = bag_poses(&bytes, Some("/pose"))?;
            survives(whole.as_bytes());
            let mut changed = 0;
            for at in 0..bytes.len() {
                for flip in [1, 0x80, 0xff] {
                    if let Some(b) = bytes.get_mut(at) {
                        *b ^= flip;
                    }
                    if let Ok(text) = bag_poses(&bytes, Some("/pose"))
                        && text != whole
                    {
                        changed += 1;
                        survives(text.as_bytes());
                    }
                    if let Ok(messages) = Messages::read(&bytes) {
                        let _ = messages.poses(Some("/path"));
                        let _ = messages.pairs("/joint_states", Field::Position, &joints);
                    }
                    if let Some(b) = bytes.get_mut(at) {
                        *b ^= flip;
                    }
                }
            }
            assert!(checked == (changed == 0), "{changed} of {}", bytes.len());
        }
    }
    Ok(())
}

/// Numbers that files have and should not have.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..3.0f64,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1e-6), Just(1e12), Just(-1e308), Just(5e-324)],
        1 => any::<f64>(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn any_bytes_survive(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        survives(&bytes);
    }

    #[test]
    fn any_csv_survives(rows in prop::collection::vec((number(), number(), number(), number()), 0..12)) {
        let mut text = "t,x,y,theta,v\n".to_owned();
        let mut t = 0.0;
        for (dt, x, y, theta) in rows {
            t += dt.abs() / 3.0;
            text.push_str(&format!("{t:?},{x:?},{y:?},{theta:?},{x:?}\n"));
        }
        survives(text.as_bytes());
    }

    #[test]
    fn any_drive_survives(steps in prop::collection::vec((1e-6..1.6f64, -1.0..1.0f64, -3.0..3.0f64), 1..24), k in number()) {
        let (mut t, mut x, mut y, mut theta) = (0.0, 0.0, 0.0, 0.0f64);
        let mut states = Vec::new();
        for (i, (dt, v, w)) in steps.into_iter().enumerate() {
            if i > 0 {
                (t, theta) = (t + dt, theta + w * dt);
                (x, y) = (x + v * dt * (theta - 0.5 * w * dt).cos(), y + v * dt * (theta - 0.5 * w * dt).sin());
            }
            let wrapped = theta.sin().atan2(theta.cos());
            let k = if k.is_finite() { k } else { 0.0 };
            states.push(format!(
                r#"{{"time":{t:?},"velocity":{v:?},"acceleration":0,"curvature":{k:?},"pose":{{"translation":{{"x":{x:?},"y":{y:?}}},"rotation":{{"radians":{wrapped:?}}}}}}}"#
            ));
        }
        survives(format!("[{}]", states.join(",")).as_bytes());
    }
}
