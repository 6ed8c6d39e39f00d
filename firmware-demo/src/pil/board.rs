//! The whole firmware of a base on behalf of a host that has its wheels, its sensors, its clock and the other end of its line.

use controller_core::base::{BaseParams, Sensed};
use controller_core::types::Pose;
use heapless::Deque;

use super::{Probe, Responder};
use crate::control::ControlTask;
use crate::control_server::{CommandReceiver, ControlServer, Queues};
use crate::drive::SimulatedDrive;
use protocol::pil::{BoardAnswer, BoardQuestion, LineBytes};
use protocol::{Frame, FrameCounters, MAX_FRAME, RejectReason, Telemetry, encode};

/// Bytes that may wait for the host to fetch them: more than a queue of reports gives in a tick.
const WAITING: usize = 4096;

/// Control server and line, with drivers simulated.
pub struct BoardPil<'queue> {
    params: BaseParams<f32>,
    queues: Option<&'queue mut Queues>,
    running: Option<Running<'queue>>,
}

struct Running<'queue> {
    server: ControlServer<'queue, SimulatedDrive>,
    receiver: CommandReceiver<'queue>,
    line: Deque<u8, WAITING>,
}

impl<'queue> BoardPil<'queue> {
    /// No base yet; it is started with `params`, as far as the host sends no others.
    pub const fn new(params: BaseParams<f32>, queues: &'queue mut Queues) -> Self {
        Self {
            params,
            queues: Some(queues),
            running: None,
        }
    }

    fn begin(&mut self, start: Pose<f32>, decimate: u16) -> BoardAnswer {
        let Ok(base) = self.params.validate() else {
            return BoardAnswer::Nack(RejectReason::Value);
        };
        let Some(queues) = self.queues.take() else {
            return BoardAnswer::Nack(RejectReason::State);
        };
        let (references, ends, receiver) = queues.split(decimate);
        let most = self.params.motion.limits.wheel_torque_nm;
        let drive = SimulatedDrive::new(base.driver(), most);
        match ControlTask::new(drive, references, self.params, start) {
            Ok(task) => {
                self.running = Some(Running {
                    server: ControlServer::new(task, ends),
                    receiver,
                    line: Deque::new(),
                });
                BoardAnswer::Ack
            }
            // The queues went with the task; the host starts the firmware anew.
            Err(_) => BoardAnswer::Nack(RejectReason::Value),
        }
    }
}

impl Running<'_> {
    fn receive(&mut self, bytes: &[u8]) -> BoardAnswer {
        for byte in bytes {
            if let Some(answer) = self.receiver.push(*byte, || 0)
                && !put(&mut self.line, &answer)
            {
                return BoardAnswer::Nack(RejectReason::Full);
            }
        }
        BoardAnswer::Ack
    }

    fn tick(&mut self, now_us: u32, sensed: &Sensed<f32>) -> BoardAnswer {
        self.server.drive_mut().set_answer(sensed.driver);
        self.server.tick(now_us, sensed);
        while let Some(report) = self.receiver.pending() {
            if !put(&mut self.line, &report) {
                return BoardAnswer::Nack(RejectReason::Full);
            }
        }
        BoardAnswer::Ticked {
            output: *self.server.task().drive().output(),
            waiting: u16::try_from(self.line.len()).unwrap_or(u16::MAX),
        }
    }

    fn send(&mut self) -> BoardAnswer {
        let line = &mut self.line;
        let bytes = core::iter::from_fn(|| line.pop_front());
        BoardAnswer::Sent(LineBytes::of(bytes.take(LineBytes::MOST)))
    }
}

/// Whether the frame found room.
fn put(line: &mut Deque<u8, WAITING>, frame: &Frame<Telemetry>) -> bool {
    let mut bytes = [0; MAX_FRAME];
    let Ok(frame) = encode(frame.sequence, &frame.message, &mut bytes) else {
        return false;
    };
    frame.iter().all(|byte| line.push_back(*byte).is_ok())
}

impl Responder for BoardPil<'_> {
    type Question = BoardQuestion;
    type Answer = BoardAnswer;

    fn answer<P: Probe>(
        &mut self,
        question: &BoardQuestion,
        _frames: FrameCounters,
        _probe: &mut P,
    ) -> BoardAnswer {
        match (question, &mut self.running) {
            (BoardQuestion::Configure(part), _) => {
                part.put(&mut self.params);
                BoardAnswer::Ack
            }
            (BoardQuestion::Begin { start, decimate }, _) => self.begin(*start, *decimate),
            (BoardQuestion::Stop, _) => BoardAnswer::Ack,
            (BoardQuestion::Receive(bytes), Some(running)) => running.receive(bytes.as_slice()),
            (BoardQuestion::Tick { now_us, sensed }, Some(running)) => {
                running.tick(*now_us, sensed)
            }
            (BoardQuestion::Send, Some(running)) => running.send(),
            (
                BoardQuestion::Receive(_) | BoardQuestion::Tick { .. } | BoardQuestion::Send,
                None,
            ) => BoardAnswer::Nack(RejectReason::State),
        }
    }

    fn is_last(question: &BoardQuestion) -> bool {
        *question == BoardQuestion::Stop
    }
}
