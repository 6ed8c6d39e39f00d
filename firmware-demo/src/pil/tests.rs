//! The loop against links in memory.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, Write};
use heapless::Vec;

use super::{End, NoProbe, serve, stand_in};
use crate::protocol::{
    Command, Decoder, MAX_CONTENT, MAX_FRAME, Measure, RejectReason, Telemetry, WirePose, encode,
};

/// Gives prepared bytes a few at a time and records the answers.
#[derive(Default)]
struct Memory {
    to_chip: Vec<u8, 1024>,
    given: usize,
    from_chip: Vec<u8, 1024>,
}

impl Memory {
    fn ask(&mut self, sequence: u16, command: &Command) {
        let mut frame = [0; MAX_FRAME];
        let frame = encode(sequence, command, &mut frame).unwrap();
        self.to_chip.extend_from_slice(frame).unwrap();
    }

    fn answers(&self) -> Vec<(u16, Telemetry), 8> {
        let mut decoder = Decoder::<Telemetry, MAX_CONTENT>::new();
        self.from_chip
            .iter()
            .filter_map(|&byte| decoder.push(byte))
            .map(|frame| frame.map(|frame| (frame.sequence, frame.message)).unwrap())
            .collect()
    }
}

impl ErrorType for Memory {
    type Error = Infallible;
}

impl Read for Memory {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, Infallible> {
        let rest = &self.to_chip[self.given..];
        let len = rest.len().min(buf.len()).min(7);
        buf[..len].copy_from_slice(&rest[..len]);
        self.given += len;
        Ok(len)
    }
}

impl Write for Memory {
    fn write(&mut self, buf: &[u8]) -> Result<usize, Infallible> {
        let len = buf.len().min(5);
        self.from_chip.extend_from_slice(&buf[..len]).unwrap();
        Ok(len)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn every_question_gets_one_answer_with_its_number() {
    let pose = WirePose {
        x: 1.0,
        y: f32::NAN,
        theta: -0.0,
    };
    let measure = Measure {
        tick: 3,
        dt: 0.001,
        pose,
        ..Measure::default()
    };
    let mut link = Memory::default();
    link.ask(1, &Command::Heartbeat);
    link.ask(2, &Command::Measure(measure));
    link.to_chip.extend_from_slice(b"rubbish\0").unwrap();
    link.ask(3, &Command::Arm);
    link.ask(4, &Command::GetCounters);
    link.ask(5, &Command::Stop);
    link.ask(6, &Command::Heartbeat);

    assert_eq!(serve(&mut link, &mut NoProbe, stand_in), End::Stopped);

    let answers = link.answers();
    let numbers: Vec<u16, 8> = answers.iter().map(|&(number, _)| number).collect();
    assert_eq!(numbers[..], [1, 2, 3, 4, 5]);
    assert!(matches!(answers[0].1, Telemetry::Hello(_)));
    let Telemetry::Report(report) = answers[1].1 else {
        panic!("{:?}", answers[1])
    };
    assert_eq!(report.e_x, -1.0);
    assert!(report.e_y.is_nan());
    assert_eq!(answers[2].1, Telemetry::Nack(RejectReason::Unsupported));
    let Telemetry::Counters(counters) = answers[3].1 else {
        panic!("{:?}", answers[3])
    };
    assert_eq!((counters.frames_good, counters.frames_rejected), (4, 1));
    assert_eq!(answers[4].1, Telemetry::Ack);
}

#[test]
fn a_closed_link_ends_the_loop() {
    let mut link = Memory::default();
    link.ask(1, &Command::Heartbeat);
    assert_eq!(serve(&mut link, &mut NoProbe, stand_in), End::Closed);
    assert_eq!(link.answers().len(), 1);
}
