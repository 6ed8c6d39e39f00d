//! The loop against links in memory.

use core::convert::Infallible;

use controller_core::paper::params::Params;
use embedded_io::{ErrorType, Read, Write};
use heapless::Vec;

use super::{End, NoProbe, Pil, serve};
use crate::protocol::{
    Command, Decoder, MAX_CONTENT, MAX_FRAME, Refusal, RejectReason, Telemetry, WireDemand,
    WireMeasured, WireReference, encode,
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

    fn answers(&self) -> Vec<(u16, Telemetry), 12> {
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

fn pil() -> Pil {
    Pil::new(Params::paper().validate().unwrap())
}

fn tick(dt: f32) -> Command {
    Command::Tick {
        dt,
        demand: WireDemand::Track(WireReference::default()),
        measured: WireMeasured::default(),
    }
}

#[test]
fn every_question_gets_one_answer_with_its_number() {
    let begin = Command::Begin {
        reference: WireReference::default(),
        measured: WireMeasured::default(),
    };
    let mut wrong = (&Params::paper()).into();
    let mut link = Memory::default();
    link.ask(1, &Command::Heartbeat);
    link.ask(2, &tick(0.001));
    link.to_chip.extend_from_slice(b"rubbish\0").unwrap();
    link.ask(3, &begin);
    link.ask(4, &tick(0.001));
    link.ask(5, &tick(0.0));
    link.ask(6, &Command::Configure(wrong));
    wrong.max_wheel_torque = Some(-1.0);
    link.ask(7, &Command::Configure(wrong));
    link.ask(8, &Command::Arm);
    link.ask(9, &Command::GetCounters);
    link.ask(10, &Command::Stop);
    link.ask(11, &Command::Heartbeat);

    assert_eq!(serve(&mut link, &mut NoProbe, &mut pil()), End::Stopped);

    let answers = link.answers();
    assert!(answers.iter().map(|&(number, _)| number).eq(1..=10));
    let mut answers = answers.iter().map(|(_, answer)| answer);
    let mut next = || answers.next().unwrap();
    assert!(matches!(next(), Telemetry::Hello(_)));
    assert_eq!(*next(), Telemetry::Nack(RejectReason::State));
    for expected in [0, 1] {
        let answer = next();
        assert!(
            matches!(answer, Telemetry::Report(report) if report.tick == expected),
            "{answer:?}"
        );
    }
    assert_eq!(*next(), Telemetry::Refused(Refusal::TickNotPositive));
    assert_eq!(*next(), Telemetry::Ack);
    assert_eq!(*next(), Telemetry::Nack(RejectReason::Value));
    assert_eq!(*next(), Telemetry::Nack(RejectReason::Unsupported));
    let counters = next();
    assert!(
        matches!(counters, Telemetry::Counters(counters)
            if (counters.frames_good, counters.frames_rejected) == (9, 1)),
        "{counters:?}"
    );
    assert_eq!(*next(), Telemetry::Ack);
}

#[test]
fn a_closed_link_ends_the_loop() {
    let mut link = Memory::default();
    link.ask(1, &Command::Heartbeat);
    assert_eq!(serve(&mut link, &mut NoProbe, &mut pil()), End::Closed);
    assert_eq!(link.answers().len(), 1);
}
