//! A controller port that asks the chip, with the host's controller as a shadow.

use super::cost::Cost;
use super::parity::{Parity, pairs};
use crate::controller_port::{Answer, ControllerPort, ControllerPortError, InProcess};
use controller_core::maths::Single;
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::ValidParams;
use controller_core::reference::Reference;
use controller_core::types::{Measured, Wrench};
use firmware_demo::host::{Chip, ChipError};
use protocol::pil::Ticked;

/// Flies with the chip's torques. The same controller in this process gets the same inputs, and
/// both reports are compared; what it computes acts on nothing.
pub struct OnChip<'a> {
    chip: &'a mut Chip,
    shadow: InProcess<f32, Single, NeuralController>,
    tick: u32,
    hand_over_step: Option<Wrench<f64>>,
    parity: Parity,
    cost: Cost,
}

/// Chip and host disagree on more than numbers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Disagreement {
    /// One of them refused the tick.
    #[error("tick {tick}: the chip says \"{chip}\", the host \"{host}\"")]
    Refusal {
        /// Tick of the run.
        tick: u32,
        /// The chip's word.
        chip: String,
        /// The host's word.
        host: String,
    },
    /// The chip counts other ticks: a question was lost or done twice.
    #[error("tick {host}: the chip is at tick {chip}")]
    Tick {
        /// Its count.
        chip: u32,
        /// Ours.
        host: u32,
    },
}

impl<'a> OnChip<'a> {
    /// A chip that was configured with `params`.
    pub fn new(chip: &'a mut Chip, params: ValidParams<f32>) -> Self {
        Self {
            chip,
            shadow: InProcess::new(params),
            tick: 0,
            hand_over_step: None,
            parity: Parity::default(),
            cost: Cost::default(),
        }
    }

    /// What the comparison has found so far.
    pub fn parity(&self) -> &Parity {
        &self.parity
    }

    /// Instructions so far.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    fn compare(
        &mut self,
        chip: Result<Ticked, ChipError>,
        host: Result<Answer, ControllerPortError>,
        handed_over: bool,
    ) -> Result<(Answer, u32), ControllerPortError> {
        let ticked = match (chip, host) {
            (Ok(ticked), Ok(_)) => ticked,
            // Both refuse: the fault of the scenario, not of the chip.
            (Err(ChipError::Refused(refusal)), Err(ControllerPortError::Fault(fault)))
                if refusal == fault.into() =>
            {
                return Err(ControllerPortError::Fault(fault));
            }
            (Err(error), host) if !matches!(error, ChipError::Refused(_)) => {
                drop(host);
                return Err(ControllerPortError::Link(Box::new(error)));
            }
            (chip, host) => {
                return Err(link(Disagreement::Refusal {
                    tick: self.tick,
                    chip: word(&chip),
                    host: word(&host),
                }));
            }
        };
        if ticked.tick != self.tick {
            return Err(link(Disagreement::Tick {
                chip: ticked.tick,
                host: self.tick,
            }));
        }
        if let Some(controller) = self.shadow.controller() {
            let host = Ticked::of(controller, handed_over);
            self.parity.compare(self.tick, pairs(&ticked, &host));
        }
        let step = ticked.hand_over_step.map(|step| step.cast());
        self.hand_over_step = step.or(self.hand_over_step);
        let answer = Answer {
            report: ticked.report.cast(),
            hand_over_step: self.hand_over_step,
            relaxing: ticked.relaxing,
        };
        Ok((answer, ticked.instructions))
    }
}

impl ControllerPort for OnChip<'_> {
    fn start(
        &mut self,
        reference: &Reference<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError> {
        self.tick = 0;
        self.hand_over_step = None;
        let chip = self
            .chip
            .begin(&reference.cast_with::<f32, Single>(), &measured.cast());
        let host = self.shadow.start(reference, measured);
        let (answer, instructions) = self.compare(chip, host, false)?;
        self.cost.start.add(instructions);
        Ok(answer)
    }

    fn step(
        &mut self,
        dt: f64,
        demand: &Demand<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError> {
        if self.shadow.controller().is_none() {
            return Err(ControllerPortError::NotStarted);
        }
        self.tick = self.tick.wrapping_add(1);
        let chip = self.chip.tick(
            dt as f32,
            &demand.cast_with::<f32, Single>(),
            &measured.cast(),
        );
        let host = self.shadow.step(dt, demand, measured);
        let handed_over = matches!(demand, Demand::HandOver { .. });
        let (answer, instructions) = self.compare(chip, host, handed_over)?;
        self.cost
            .add(answer.report.phase, handed_over, instructions);
        Ok(answer)
    }
}

fn link(error: Disagreement) -> ControllerPortError {
    ControllerPortError::Link(Box::new(error))
}

fn word<T, E: std::fmt::Display>(outcome: &Result<T, E>) -> String {
    match outcome {
        Ok(_) => "done".to_owned(),
        Err(error) => error.to_string(),
    }
}
