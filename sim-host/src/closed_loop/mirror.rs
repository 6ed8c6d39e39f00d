//! The same base somewhere else, in lock step.

use controller_core::base::BaseParams;
use controller_core::types::Pose;
use protocol::pil::{BaseInput, BaseTicked, WheelOutput};
use protocol::{Command, RejectReason};
use std::error::Error;

/// Why a mirror does not answer.
pub type MirrorError = Box<dyn Error + Send + Sync>;

/// The same base somewhere else, on a chip for example: it gets whatever the base here gets, and what it puts out moves
/// the plant. It may move to another thread together with the base here.
pub trait Mirror: Send {
    /// A base as the one here, disarmed.
    ///
    /// # Errors
    /// It cannot be reached, or refuses the parameters.
    fn begin(&mut self, params: &BaseParams<f32>, start: Pose<f32>) -> Result<(), MirrorError>;

    /// A command, to which the base here has given this `answer`.
    ///
    /// # Errors
    /// It cannot be reached, or answers otherwise.
    fn command(
        &mut self,
        command: &Command,
        answer: Result<(), RejectReason>,
    ) -> Result<(), MirrorError>;

    /// A tick, of which the base `here` made this; what is put out there.
    ///
    /// # Errors
    /// It cannot be reached.
    fn tick(&mut self, input: &BaseInput, here: &BaseTicked) -> Result<WheelOutput, MirrorError>;
}
