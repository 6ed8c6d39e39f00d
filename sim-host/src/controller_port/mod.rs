//! Who computes the torques: a controller in this process, or one on a chip.
//!
//! The loop knows a [`ControllerPort`] only. Its quantities are `f64`; one that computes in single
//! precision rounds each input once, with `cast`, and casts its report back, which is exact. So
//! `value as f32` of anything in a report gives the very bits that the controller computed, and a
//! controller on an emulated chip that gets the same inputs can be compared bit for bit.

mod factory;
mod in_process;

pub use factory::for_scenario;
pub use in_process::{Control, InProcess};

use controller_core::error::StepFault;
use controller_core::paper::demand::Demand;
use controller_core::paper::report::StepReport;
use controller_core::reference::Reference;
use controller_core::types::{Measured, Wrench};

/// The answer to a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answer {
    /// Everything that the controller computed.
    pub report: StepReport<f64>,
    /// From the hand-over on: the step that it put into the wrench.
    pub hand_over_step: Option<Wrench<f64>>,
    /// An acceleration neuron is outside its bounds and on its way back.
    pub relaxing: bool,
}

/// A controller as the closed loop sees it.
pub trait ControllerPort {
    /// Starts tracking at t = 0 and gives the first torques. May be called again to start over.
    ///
    /// # Errors
    /// See [`ControllerPortError`].
    fn start(
        &mut self,
        reference: &Reference<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError>;

    /// One tick, `dt` \[s\] after the last.
    ///
    /// # Errors
    /// See [`ControllerPortError`]. The torques of the last report are then no longer to be trusted.
    fn step(
        &mut self,
        dt: f64,
        demand: &Demand<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError>;
}

/// Why a controller port gives no torques.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ControllerPortError {
    /// The controller refused the tick.
    #[error("the controller refused: {0}")]
    Fault(StepFault),
    /// `step` before `start`.
    #[error("the controller was not started")]
    NotStarted,
    /// The controller cannot be reached, or answers nonsense.
    #[error("no answer from the controller")]
    Link(#[source] Box<dyn std::error::Error + Send + Sync>),
}

impl From<StepFault> for ControllerPortError {
    fn from(fault: StepFault) -> Self {
        Self::Fault(fault)
    }
}
