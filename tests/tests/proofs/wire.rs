//! Theorem 6: the decoder says of every sequence of bytes what a textbook says of it.

use protocol::{Decoder, FrameError, VERSION};

/// Bytes, and runs of them, of which sequences are made.
fn tokens() -> Vec<Vec<u8>> {
    let content = |version: u8, sequence: u16, payload: &[u8]| {
        let [low, high] = sequence.to_le_bytes();
        let mut content = vec![version, low, high];
        content.extend(payload);
        content.extend(crc(&content).to_le_bytes());
        content
    };
    let mut damaged = content(VERSION, 3, &[7]);
    damaged[3] ^= 1;
    let mut tokens: Vec<Vec<u8>> = [0, 1, 2, 9, 0xFF].map(|byte| vec![byte]).into();
    tokens.extend([
        stuffed(&content(VERSION, 0x0102, &[7])),
        stuffed(&content(VERSION, 0, &[0])),
        stuffed(&content(VERSION.wrapping_add(1), 3, &[7])),
        stuffed(&content(VERSION, 3, &[7, 8])),
        stuffed(&damaged),
    ]);
    tokens
}

/// CRC-32/ISO-HDLC, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    !crc
}

/// Groups between zeros, each behind its length and one; no delimiter.
fn stuffed(content: &[u8]) -> Vec<u8> {
    let groups = content.split(|byte| *byte == 0);
    groups
        .flat_map(|group| std::iter::once(group.len() as u8 + 1).chain(group.iter().copied()))
        .collect()
}

/// The content of what stands between two delimiters; `None` if a group is cut off.
fn unstuffed(mut wire: &[u8]) -> Option<Vec<u8>> {
    let mut content = Vec::new();
    while let Some((&code, rest)) = wire.split_first() {
        let group = rest.get(..usize::from(code) - 1)?;
        content.extend(group);
        wire = &rest[group.len()..];
        if code != 0xFF && !wire.is_empty() {
            content.push(0);
        }
    }
    Some(content)
}

/// What is to be said of what stands between two delimiters.
fn judged(wire: &[u8], room: usize) -> Result<(u16, u8), FrameError> {
    let long = |content: &[u8]| content.len() > room;
    let Some(content) = unstuffed(wire) else {
        // What is there already may be too long.
        let mut whole = wire.to_vec();
        loop {
            whole.push(1);
            if let Some(content) = unstuffed(&whole) {
                let missing = whole.len() - wire.len();
                let there = &content[..content.len() - missing];
                return Err(if long(there) {
                    FrameError::Length
                } else {
                    FrameError::Framing
                });
            }
        }
    };
    if long(&content) || content.len() < 7 {
        return Err(FrameError::Length);
    }
    let (checked, check) = content.split_at(content.len() - 4);
    if crc(checked).to_le_bytes() != check {
        return Err(FrameError::Crc);
    }
    match checked {
        [version, ..] if *version != VERSION => Err(FrameError::Version),
        [_, low, high, message] => Ok((u16::from_le_bytes([*low, *high]), *message)),
        _ => Err(FrameError::Payload),
    }
}

/// All sequences of five tokens, a delimiter, and a frame behind them, in rooms that are too small, just right and wide.
fn agree<const N: usize>() {
    let tokens = tokens();
    let last = [tokens[5].as_slice(), &[0]].concat();
    let count = tokens.len().pow(5);
    let mut accepted = 0_u32;
    for number in 0..count {
        let mut bytes = Vec::new();
        for place in 0..5 {
            bytes.extend(&tokens[number / tokens.len().pow(place) % tokens.len()]);
        }
        bytes.push(0);
        bytes.extend(&last);
        let mut decoder = Decoder::<u8, N>::new();
        let found: Vec<_> = bytes
            .iter()
            .filter_map(|byte| decoder.push(*byte))
            .map(|frame| frame.map(|frame| (frame.sequence, frame.message)))
            .collect();
        let between = bytes[..bytes.len() - 1].split(|byte| *byte == 0);
        let expected: Vec<_> = between
            .filter(|wire| !wire.is_empty())
            .map(|wire| judged(wire, N))
            .collect();
        assert_eq!(found, expected, "{bytes:?}");
        let good = found.iter().filter(|frame| frame.is_ok()).count() as u32;
        let counters = decoder.counters();
        assert_eq!(
            (counters.good, counters.rejected()),
            (good, found.len() as u32 - good)
        );
        // Whatever came before, the frame behind the delimiter is taken.
        assert_eq!(found.last(), Some(&judged(&last[..last.len() - 1], N)));
        accepted += good;
    }
    println!("{count} sequences, {accepted} frames in a room of {N}");
}

#[test]
fn the_decoder_is_a_textbook_s_for_every_sequence() {
    agree::<7>();
    agree::<8>();
    agree::<64>();
}
