//! The loop against links in memory.

use core::convert::Infallible;

use controller_core::paper::params::Params;
use embedded_io::{ErrorType, Read, Write};
use heapless::Vec;

use super::{End, NoProbe, Pil, serve};
use protocol::pil::{Answer, Question, Refusal, WireDemand, WireMeasured};
use protocol::{Decoder, MAX_CONTENT, MAX_FRAME, RejectReason, WireReference, encode};

/// Gives prepared bytes a few at a time and records the answers.
#[derive(Default)]
struct Memory {
    to_chip: Vec<u8, 1024>,
    given: usize,
    from_chip: Vec<u8, 1024>,
}

impl Memory {
    fn ask(&mut self, sequence: u16, command: &Question) {
        let mut frame = [0; MAX_FRAME];
        let frame = encode(sequence, command, &mut frame).unwrap();
        self.to_chip.extend_from_slice(frame).unwrap();
    }

    fn answers(&self) -> Vec<(u16, Answer), 12> {
        let mut decoder = Decoder::<Answer, MAX_CONTENT>::new();
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

fn tick(dt: f32) -> Question {
    Question::Tick {
        dt,
        demand: WireDemand::Track(WireReference::default()),
        measured: WireMeasured::default(),
    }
}

#[test]
fn every_question_gets_one_answer_with_its_number() {
    let begin = Question::Begin {
        reference: WireReference::default(),
        measured: WireMeasured::default(),
    };
    let mut wrong = (&Params::paper()).into();
    let mut link = Memory::default();
    link.ask(1, &Question::Hello);
    link.ask(2, &tick(0.001));
    link.to_chip.extend_from_slice(b"rubbish\0").unwrap();
    link.ask(3, &begin);
    link.ask(4, &tick(0.001));
    link.ask(5, &tick(0.0));
    link.ask(6, &Question::Configure(wrong));
    wrong.max_wheel_torque = Some(-1.0);
    link.ask(7, &Question::Configure(wrong));
    link.ask(8, &Question::GetCounters);
    link.ask(9, &Question::Stop);
    link.ask(10, &Question::Hello);

    assert_eq!(serve(&mut link, &mut NoProbe, &mut pil()), End::Stopped);

    let answers = link.answers();
    assert!(answers.iter().map(|&(number, _)| number).eq(1..=9));
    let mut answers = answers.iter().map(|(_, answer)| answer);
    let mut next = || answers.next().unwrap();
    assert!(matches!(next(), Answer::Hello(_)));
    assert_eq!(*next(), Answer::Nack(RejectReason::State));
    for expected in [0, 1] {
        let answer = next();
        assert!(
            matches!(answer, Answer::Report(report) if report.tick == expected),
            "{answer:?}"
        );
    }
    assert_eq!(*next(), Answer::Refused(Refusal::TickNotPositive));
    assert_eq!(*next(), Answer::Ack);
    assert_eq!(*next(), Answer::Nack(RejectReason::Value));
    let counters = next();
    assert!(
        matches!(counters, Answer::Counters(counters)
            if (counters.frames_good, counters.frames_rejected) == (8, 1)),
        "{counters:?}"
    );
    assert_eq!(*next(), Answer::Ack);
}

#[test]
fn a_closed_link_ends_the_loop() {
    let mut link = Memory::default();
    link.ask(1, &Question::Hello);
    assert_eq!(serve(&mut link, &mut NoProbe, &mut pil()), End::Closed);
    assert_eq!(link.answers().len(), 1);
}
