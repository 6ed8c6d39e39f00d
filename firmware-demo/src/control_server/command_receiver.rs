//! The background's half: bytes in, answers out.

use core::sync::atomic::Ordering;

use controller_core::motion::{check_goal, check_order};
use controller_core::queue::{PushError, ReferenceProducer, TimedReference};
use controller_core::reference::Reference;

use super::{Answer, PERIODIC, Periodic, REPORTS, REQUESTS, Request, Shared, outcome};
use crate::queue::{Receiver, Sender};
use protocol::{
    Command, Counters, Decoder, Frame, Hello, MAX_CONTENT, RejectReason, Telemetry, TimedSample,
};

/// The background's side: bytes from the line, answers to it.
pub struct CommandReceiver<'queue> {
    decoder: Decoder<Command, MAX_CONTENT>,
    samples: ReferenceProducer<'queue, f32>,
    requests: Sender<'queue, Request, REQUESTS>,
    periodic: Sender<'queue, Request<Periodic>, PERIODIC>,
    answers: Receiver<'queue, Answer, REPORTS>,
    shared: &'queue Shared,
    /// Of the last command on its way to the tick.
    number: u32,
    /// Answers that found no room on their way to the line.
    dropped: u32,
    /// Changes of state when the present trajectory began.
    trajectory: u32,
}

impl<'queue> CommandReceiver<'queue> {
    pub(super) const fn new(
        samples: ReferenceProducer<'queue, f32>,
        requests: Sender<'queue, Request, REQUESTS>,
        periodic: Sender<'queue, Request<Periodic>, PERIODIC>,
        answers: Receiver<'queue, Answer, REPORTS>,
        shared: &'queue Shared,
    ) -> Self {
        Self {
            decoder: Decoder::new(),
            samples,
            requests,
            periodic,
            answers,
            shared,
            number: 0,
            dropped: 0,
            trajectory: 0,
        }
    }

    /// Takes one byte from the line. Stops and some other commands are answered here, the others by the tick.
    pub fn push(&mut self, byte: u8, stack_bytes: impl FnOnce() -> u32) -> Option<Answer> {
        let Ok(frame) = self.decoder.push(byte)? else {
            return None;
        };
        let Frame { sequence, message } = frame;
        let frames = self.decoder.counters();
        self.shared.frames.store(frames.good, Ordering::Relaxed);
        let answer = match message {
            Command::Heartbeat => {
                let heartbeats = &self.shared.heartbeats;
                let count = heartbeats.load(Ordering::Relaxed);
                heartbeats.store(count.wrapping_add(1), Ordering::Relaxed);
                Telemetry::Hello(Hello {
                    period_us: self.shared.period_us.load(Ordering::Relaxed),
                    ..Hello::OURS
                })
            }
            Command::GetCounters => Telemetry::Counters(Counters {
                frames_good: frames.good,
                frames_rejected: frames.rejected(),
                reports_dropped: self
                    .shared
                    .dropped
                    .load(Ordering::Relaxed)
                    .saturating_add(self.dropped),
                overruns: self.shared.overruns.load(Ordering::Relaxed),
                stack_bytes: stack_bytes(),
            }),
            Command::Sample(sample) => outcome(self.sample(&sample)),
            command => {
                self.number = self.number.wrapping_add(1);
                let number = self.number;
                if self.shared.stops.take(&command, number) {
                    Telemetry::Ack
                } else if self.enqueue(number, frame) {
                    return None;
                } else {
                    Telemetry::Nack(RejectReason::Full)
                }
            }
        };
        Some(Frame {
            sequence,
            message: answer,
        })
    }

    /// An answer of [`push`](Self::push) found no room on its way to the line.
    pub const fn count_dropped(&mut self) {
        self.dropped = self.dropped.saturating_add(1);
    }

    /// What the tick has to say, oldest first.
    pub fn pending(&mut self) -> Option<Answer> {
        self.answers.receive()
    }

    /// On its way to the tick, if there is room.
    fn enqueue(&mut self, number: u32, frame: Frame<Command>) -> bool {
        let sequence = frame.sequence;
        match Periodic::of(&frame.message) {
            Some(message) => self.periodic.send(Request {
                number,
                frame: Frame { sequence, message },
            }),
            None => self.requests.send(Request { number, frame }),
        }
    }

    fn sample(&mut self, sample: &TimedSample) -> Result<(), RejectReason> {
        let state = self.shared.state.load(Ordering::Acquire);
        if state & 1 == 0 {
            return Err(RejectReason::State);
        }
        let sample: TimedReference<f32> = sample.into();
        if !is_one(&sample.reference) {
            return Err(RejectReason::Value);
        }
        // The first one after the robot came to accept samples begins a trajectory, at whatever time.
        if self.trajectory != state {
            self.samples.restart();
            self.trajectory = state;
        }
        self.samples.push(sample).map_err(|error| match error {
            PushError::Full => RejectReason::Full,
            _ => RejectReason::Value,
        })
    }
}

/// Largest accelerations of a sample \[m/s², rad/s²\]: as of [`Limits`](controller_core::motion::Limits).
const LARGEST: (f32, f32) = (1.0e3, 1.0e4);

/// Beyond these a sample is a mistake in the unit or in the sender; in the tick it would be a fault.
fn is_one(reference: &Reference<f32>) -> bool {
    let accel = reference.accel();
    check_goal(reference.pose()).is_ok()
        && check_order(reference.twist()).is_ok()
        && accel.linear.abs() <= LARGEST.0
        && accel.angular.abs() <= LARGEST.1
}
