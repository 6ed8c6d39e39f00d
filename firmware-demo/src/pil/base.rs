//! The whole base on behalf of a host that has its wheels, its sensors and its clock.

use controller_core::base::BaseParams;
use controller_core::queue::ReferenceConsumer;
use controller_core::types::Pose;

use super::{Probe, Responder, counters};
use crate::control::ControlTask;
use crate::drive::SimulatedDrive;
use protocol::pil::{BaseAnswer, BaseInput, BaseQuestion, BaseTicked};
use protocol::{FrameCounters, Hello, RejectReason};

/// The control task, with its drivers simulated: see [`SimulatedDrive`].
pub struct BasePil<'queue> {
    params: BaseParams<f32>,
    /// Each order comes with its tick, so nothing goes through the queue. The task has it while there is one.
    references: Option<ReferenceConsumer<'queue, f32>>,
    task: Option<ControlTask<'queue, SimulatedDrive>>,
}

impl<'queue> BasePil<'queue> {
    /// No base yet; the first is started with `params`, as far as the host sends no others.
    pub const fn new(params: BaseParams<f32>, references: ReferenceConsumer<'queue, f32>) -> Self {
        Self {
            params,
            references: Some(references),
            task: None,
        }
    }

    fn begin(&mut self, start: Pose<f32>) -> BaseAnswer {
        if let Some(task) = self.task.take() {
            self.references = Some(task.into_references());
        }
        let Ok(base) = self.params.validate() else {
            return BaseAnswer::Nack(RejectReason::Value);
        };
        let Some(references) = self.references.take() else {
            return BaseAnswer::Nack(RejectReason::State);
        };
        let most = self.params.motion.limits.wheel_torque_nm;
        let drive = SimulatedDrive::new(base.driver(), most);
        match ControlTask::new(drive, references, self.params, start) {
            Ok(task) => {
                self.task = Some(task);
                BaseAnswer::Ack
            }
            // The queue went with the task; the host starts the firmware anew.
            Err(_) => BaseAnswer::Nack(RejectReason::Value),
        }
    }

    fn tick<P: Probe>(&mut self, input: &BaseInput, probe: &mut P) -> BaseAnswer {
        let Some(task) = &mut self.task else {
            return BaseAnswer::Nack(RejectReason::State);
        };
        let BaseInput {
            now_us,
            order,
            sensed,
        } = input;
        let order = order.into();
        task.drive_mut().set_answer(sensed.driver);
        let ((), instructions) = probe.count(|| {
            task.tick_with(*now_us, &order, sensed);
        });
        BaseAnswer::Ticked(BaseTicked {
            tick: task.telemetry(),
            output: *task.drive().output(),
            instructions,
        })
    }
}

impl Responder for BasePil<'_> {
    type Question = BaseQuestion;
    type Answer = BaseAnswer;

    /// The instructions of a tick are those of the control task, the drivers' included; reading the question and
    /// writing the answer come on top.
    fn answer<P: Probe>(
        &mut self,
        question: &BaseQuestion,
        frames: FrameCounters,
        probe: &mut P,
    ) -> BaseAnswer {
        match question {
            BaseQuestion::Tick(input) => self.tick(input, probe),
            BaseQuestion::Command(command) => {
                let Some(task) = &mut self.task else {
                    return BaseAnswer::Nack(RejectReason::State);
                };
                match task.command(command) {
                    Ok(()) => BaseAnswer::Ack,
                    Err(reason) => BaseAnswer::Nack(reason),
                }
            }
            BaseQuestion::Configure(part) => {
                part.put(&mut self.params);
                BaseAnswer::Ack
            }
            BaseQuestion::Begin { start } => self.begin(*start),
            BaseQuestion::GetCounters => BaseAnswer::Counters(counters(frames, probe)),
            BaseQuestion::Hello => BaseAnswer::Hello(Hello::OURS),
            BaseQuestion::Stop => BaseAnswer::Ack,
        }
    }

    fn is_last(question: &BaseQuestion) -> bool {
        *question == BaseQuestion::Stop
    }
}
