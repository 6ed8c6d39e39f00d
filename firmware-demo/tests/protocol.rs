//! The protocol against hostile lines: whatever arrives, no panic, no wrong message, and back in step soon.

use crate::commands::command;
use crate::questions::question;
use proptest::collection::vec;
use proptest::prelude::*;
use protocol::pil::{Answer, Question, Report};
use protocol::{
    Command, Decoder, FrameCounters, FrameError, MAX_CONTENT, MAX_FRAME, VERSION, WirePose, encode,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

type Outcome<M> = Result<(u16, M), FrameError>;

fn frame(sequence: u16, message: &impl Serialize) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    encode(sequence, message, &mut out)
        .expect("every message fits")
        .to_vec()
}

fn decode(bytes: &[u8]) -> (Vec<Outcome<Command>>, FrameCounters) {
    decode_as(bytes)
}

fn decode_as<M: DeserializeOwned>(bytes: &[u8]) -> (Vec<Outcome<M>>, FrameCounters) {
    let mut decoder = Decoder::<M, MAX_CONTENT>::new();
    let outcomes = bytes
        .iter()
        .filter_map(|&byte| decoder.push(byte))
        .map(|outcome| outcome.map(|frame| (frame.sequence, frame.message)))
        .collect();
    (outcomes, decoder.counters())
}

/// The wire format written again, bit by bit: no table, no stuffing in place.
fn reference_frame(version: u8, sequence: u16, payload: &[u8]) -> Vec<u8> {
    let mut content = vec![version];
    content.extend(sequence.to_le_bytes());
    content.extend(payload);
    let crc = content.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 {
                (crc >> 1) ^ 0xEDB8_8320
            } else {
                crc >> 1
            }
        })
    });
    content.extend((!crc).to_le_bytes());
    let mut wire = Vec::new();
    for group in content.split(|&byte| byte == 0) {
        assert!(group.len() < 254, "longer groups are not written here");
        wire.push(group.len() as u8 + 1);
        wire.extend(group);
    }
    wire.push(0);
    wire
}

proptest! {
    #[test]
    fn any_bytes_are_survived_and_every_outcome_is_counted(bytes in vec(any::<u8>(), 0..2000)) {
        let (outcomes, counters) = decode(&bytes);
        let good = outcomes.iter().filter(|outcome| outcome.is_ok()).count();
        prop_assert_eq!(counters.good as usize, good);
        prop_assert_eq!(counters.rejected() as usize, outcomes.len() - good);
    }

    /// Random bytes hardly ever pass the check, so give the message reader bytes that do.
    #[test]
    fn any_payload_is_survived(payload in vec(any::<u8>(), 0..240), sequence in any::<u16>()) {
        let (outcomes, _) = decode(&reference_frame(VERSION, sequence, &payload));
        prop_assert_eq!(outcomes.len(), 1);
        match &outcomes[0] {
            Ok((number, _)) => prop_assert_eq!(*number, sequence),
            Err(error) => prop_assert_eq!(*error, FrameError::Payload),
        }
    }

    #[test]
    fn every_command_arrives_bit_for_bit(command in command(), sequence in any::<u16>()) {
        let sent = frame(sequence, &command);
        let (outcomes, _) = decode(&sent);
        prop_assert_eq!(outcomes.len(), 1);
        let (number, arrived) = outcomes[0].expect("an undamaged frame");
        prop_assert_eq!(number, sequence);
        // NaN equals nothing, so compare what the copy encodes to.
        prop_assert_eq!(frame(number, &arrived), sent);
    }

    #[test]
    fn every_question_arrives_bit_for_bit(question in question(), sequence in any::<u16>()) {
        let sent = frame(sequence, &question);
        let (outcomes, _) = decode_as::<Question>(&sent);
        prop_assert_eq!(outcomes.len(), 1);
        let (number, arrived) = outcomes[0].expect("an undamaged frame");
        prop_assert_eq!(number, sequence);
        prop_assert_eq!(frame(number, &arrived), sent);
    }

    #[test]
    fn wire_format_is_the_documented_one(command in command(), sequence in any::<u16>()) {
        let mut buffer = [0; MAX_FRAME];
        let payload = postcard::to_slice(&command, &mut buffer).expect("it fits");
        prop_assert_eq!(reference_frame(VERSION, sequence, payload), frame(sequence, &command));
    }

    #[test]
    fn one_changed_byte_is_rejected(
        command in command(), at in any::<prop::sample::Index>(), change in 1_u8..,
    ) {
        let mut bytes = frame(1, &command);
        let at = at.index(bytes.len());
        bytes[at] ^= change;
        bytes.push(0);
        let (outcomes, _) = decode(&bytes);
        prop_assert!(!outcomes.is_empty());
        prop_assert!(outcomes.iter().all(Result::is_err), "{outcomes:?}");
    }

    #[test]
    fn a_lost_run_of_bytes_is_rejected(
        command in command(), from in any::<prop::sample::Index>(), len in 1_usize..20,
    ) {
        let mut bytes = frame(1, &command);
        // All but the delimiter may be lost.
        let from = from.index(bytes.len() - 1);
        let to = (from + len).min(bytes.len() - 1);
        bytes.drain(from..to);
        let (outcomes, _) = decode(&bytes);
        prop_assert!(outcomes.iter().all(Result::is_err), "{outcomes:?}");
    }

    #[test]
    fn an_inserted_byte_is_rejected(
        command in command(), at in any::<prop::sample::Index>(), byte in any::<u8>(),
    ) {
        let mut bytes = frame(1, &command);
        let at = at.index(bytes.len());
        // A delimiter before or after a frame is idle filling and harms nothing.
        prop_assume!(byte != 0 || (at != 0 && at != bytes.len() - 1));
        bytes.insert(at, byte);
        let (outcomes, _) = decode(&bytes);
        prop_assert!(outcomes.iter().all(Result::is_err), "{outcomes:?}");
    }

    #[test]
    fn in_step_again_at_the_second_frame_after_rubbish(
        rubbish in vec(any::<u8>(), 0..600), command in command(),
    ) {
        let mut bytes = rubbish;
        for sequence in 1..=3 {
            bytes.extend(frame(sequence, &command));
        }
        let (outcomes, _) = decode(&bytes);
        let numbers: Vec<_> = outcomes.iter().flatten().map(|(number, _)| *number).collect();
        prop_assert!(numbers.ends_with(&[2, 3]), "{numbers:?}");
    }

    #[test]
    fn a_short_buffer_is_refused_and_never_overrun(command in command(), len in 0_usize..MAX_FRAME) {
        let whole = frame(9, &command);
        let mut out = [0xEE; MAX_FRAME];
        let fits = encode(9, &command, &mut out[..len]).is_ok();
        prop_assert_eq!(fits, len >= whole.len());
        prop_assert!(out[len..].iter().all(|&byte| byte == 0xEE));
    }
}

#[test]
fn every_change_of_every_byte_is_rejected() {
    let sent = frame(
        0x0100,
        &Command::Park {
            goal: WirePose {
                x: 1.0,
                y: 0.0,
                theta: -2.5,
            },
        },
    );
    for at in 0..sent.len() {
        for change in 1..=u8::MAX {
            let mut bytes = sent.clone();
            bytes[at] ^= change;
            bytes.push(0);
            let (outcomes, _) = decode(&bytes);
            assert!(
                outcomes.iter().all(Result::is_err),
                "byte {at} changed by {change:#04x}"
            );
        }
    }
}

#[test]
fn reports_arrive_bit_for_bit() {
    let signalling = f32::from_bits(0x7F80_0001);
    let report = Report {
        tick: 7,
        e_x: f32::NAN,
        s1: signalling,
        tau_left: -0.0,
        ..Report::default()
    };
    let mut out = [0; MAX_FRAME];
    let sent = encode(3, &Answer::Report(report), &mut out)
        .expect("it fits")
        .to_vec();
    let mut decoder = Decoder::<Answer, MAX_CONTENT>::new();
    let arrived = sent
        .iter()
        .find_map(|&byte| decoder.push(byte))
        .expect("a frame")
        .expect("sound");
    let Answer::Report(copy) = arrived.message else {
        panic!("{arrived:?}")
    };
    assert_eq!(copy.e_x.to_bits(), f32::NAN.to_bits());
    assert_eq!(copy.s1.to_bits(), signalling.to_bits());
    assert_eq!(copy.tau_left.to_bits(), (-0.0_f32).to_bits());
}

#[test]
fn each_kind_of_damage_has_its_counter() {
    let sound = frame(1, &Command::Arm);
    let mut payload = [0; 8];
    let arm = postcard::to_slice(&Command::Arm, &mut payload)
        .expect("it fits")
        .to_vec();
    let spare = [&arm[..], &[1]].concat();
    let mut bytes = vec![0, 0, 0];
    bytes.extend(&sound);
    bytes.extend(reference_frame(VERSION + 1, 1, &arm));
    bytes.extend(reference_frame(VERSION, 1, &spare));
    bytes.extend(reference_frame(VERSION, 1, &[0xFF]));
    bytes.extend([5, 1, 0]);
    bytes.extend([1, 1, 0]);
    bytes.extend([1; 400]);
    bytes.push(0);
    bytes.extend([1; 9]);
    bytes.push(0);
    bytes.extend(&sound);
    let (outcomes, counters) = decode(&bytes);
    let expected = FrameCounters {
        good: 2,
        framing: 1,
        length: 2,
        crc: 1,
        version: 1,
        payload: 2,
    };
    assert_eq!(counters, expected, "{outcomes:?}");
}
