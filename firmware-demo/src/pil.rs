//! Processor in the loop: the host owns the plant, this side owns the controller.
//!
//! One question, one answer, in lock step, over any byte link. The loop is the same on every board and, with
//! links in memory, in the host's tests; it serves the paper's law ([`Pil`]) or the whole base ([`BasePil`]).

mod base;
mod board;

pub use base::BasePil;
pub use board::BoardPil;

use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::{Params, ValidParams};
use controller_core::types::Measured;
use embedded_io::{Read, Write};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::line::send;
use protocol::pil::{Answer, Question, Ticked, WireDemand};
use protocol::{Counters, Decoder, Frame, FrameCounters, Hello, MAX_CONTENT, RejectReason};

/// Bytes asked of the link at once; a whole question fits.
const CHUNK: usize = 128;

/// What a board can measure of a tick; the defaults are those of a board that cannot.
pub trait Probe {
    /// Runs `work` and counts its executed instructions.
    fn count<R>(&mut self, work: impl FnOnce() -> R) -> (R, u32) {
        (work(), 0)
    }

    /// High-water mark of the stack in bytes.
    fn stack_bytes(&self) -> u32 {
        0
    }
}

/// The probe of a board that can measure nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoProbe;

impl Probe for NoProbe {}

/// What answers a host's questions.
pub trait Responder {
    /// What is asked.
    type Question: DeserializeOwned;
    /// What is answered.
    type Answer: Serialize;

    /// The answer to one question; `frames` is what the link's decoder has seen.
    fn answer<P: Probe>(
        &mut self,
        question: &Self::Question,
        frames: FrameCounters,
        probe: &mut P,
    ) -> Self::Answer;

    /// Nothing comes after this question.
    fn is_last(question: &Self::Question) -> bool;
}

/// Why the loop ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The host said stop.
    Stopped,
    /// The host closed the link.
    Closed,
    /// The link failed.
    Broken,
}

/// The controller on behalf of a host.
#[derive(Clone, Copy, Debug)]
pub struct Pil {
    params: ValidParams<f32>,
    controller: Option<NeuralController>,
    tick: u32,
}

impl Pil {
    /// No controller is running; the next one is started with `params` unless the host sends others.
    pub const fn new(params: ValidParams<f32>) -> Self {
        Self {
            params,
            controller: None,
            tick: 0,
        }
    }

    fn tick<P: Probe>(
        &mut self,
        dt: f32,
        demand: &WireDemand,
        measured: &Measured<f32>,
        probe: &mut P,
    ) -> Answer {
        let Some(controller) = &mut self.controller else {
            return Answer::Nack(RejectReason::State);
        };
        let demand: Demand<f32> = demand.into();
        let (outcome, instructions) = probe.count(|| controller.step(dt, &demand, measured));
        if let Err(fault) = outcome {
            return Answer::Refused(fault.into());
        }
        self.tick = self.tick.wrapping_add(1);
        let handed_over = matches!(demand, Demand::HandOver { .. });
        report(Ticked::of(controller, handed_over), self.tick, instructions)
    }
}

impl Responder for Pil {
    type Question = Question;
    type Answer = Answer;

    /// The instructions in a report are those of the core's `step` (or `start`) alone, its report included;
    /// reading the question and writing the answer come on top.
    fn answer<P: Probe>(
        &mut self,
        question: &Question,
        frames: FrameCounters,
        probe: &mut P,
    ) -> Answer {
        match question {
            Question::Tick {
                dt,
                demand,
                measured,
            } => self.tick(*dt, demand, &measured.into(), probe),
            Question::Begin {
                reference,
                measured,
            } => {
                let (reference, measured) = (reference.into(), measured.into());
                let params = &self.params;
                let (started, instructions) =
                    probe.count(|| NeuralController::start(params, &reference, &measured));
                match started {
                    Ok(controller) => {
                        self.tick = 0;
                        self.controller = Some(controller);
                        report(Ticked::of(&controller, false), 0, instructions)
                    }
                    Err(fault) => Answer::Refused(fault.into()),
                }
            }
            Question::Configure(set) => match Params::from(set).validate() {
                Ok(params) => {
                    self.params = params;
                    Answer::Ack
                }
                Err(_) => Answer::Nack(RejectReason::Value),
            },
            Question::GetCounters => Answer::Counters(counters(frames, probe)),
            Question::Hello => Answer::Hello(Hello::OURS),
            Question::Stop => Answer::Ack,
        }
    }

    fn is_last(question: &Question) -> bool {
        *question == Question::Stop
    }
}

/// What a link and its board have counted.
fn counters<P: Probe>(frames: FrameCounters, probe: &P) -> Counters {
    Counters {
        frames_good: frames.good,
        frames_rejected: frames.rejected(),
        stack_bytes: probe.stack_bytes(),
        ..Counters::default()
    }
}

fn report(ticked: Ticked, tick: u32, instructions: u32) -> Answer {
    let ticked = Ticked {
        tick,
        instructions,
        ..ticked
    };
    Answer::Report((&ticked).into())
}

/// Answers the host until it stops, closes or breaks the link.
///
/// Each answer carries the sequence number of its question. Damaged frames are counted and not answered.
pub fn serve<L: Read + Write, P: Probe, R: Responder>(
    link: &mut L,
    probe: &mut P,
    responder: &mut R,
) -> End {
    let mut decoder = Decoder::<R::Question, MAX_CONTENT>::new();
    let mut chunk = [0; CHUNK];
    loop {
        let received = match link.read(&mut chunk) {
            Ok(0) => return End::Closed,
            Ok(len) => chunk.get(..len).unwrap_or_default(),
            Err(_) => return End::Broken,
        };
        for &byte in received {
            let Some(Ok(frame)) = decoder.push(byte) else {
                continue;
            };
            let answer = Frame {
                sequence: frame.sequence,
                message: responder.answer(&frame.message, decoder.counters(), probe),
            };
            if !send(link, &answer) {
                return End::Broken;
            }
            if R::is_last(&frame.message) {
                return End::Stopped;
            }
        }
    }
}

#[cfg(test)]
mod tests;
