//! The same base somewhere else, in lock step.

use controller_core::base::{BaseParams, Sensed};
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

/// The same firmware somewhere else, line included: it gets the bytes that the firmware here gets, and what it puts out moves the
/// plant.
pub trait LineMirror: Send {
    /// A base as the one here, disarmed; one report of `decimate` goes to its line.
    ///
    /// # Errors
    /// It cannot be reached, or refuses the parameters.
    fn begin(
        &mut self,
        params: &BaseParams<f32>,
        start: Pose<f32>,
        decimate: u16,
    ) -> Result<(), MirrorError>;

    /// A tick, before which these bytes came over the line; what is put out there, and the bytes of its line.
    ///
    /// # Errors
    /// It cannot be reached.
    fn tick(
        &mut self,
        line: &[u8],
        now_us: u32,
        sensed: &Sensed<f32>,
    ) -> Result<(WheelOutput, Vec<u8>), MirrorError>;
}

#[cfg(not(target_family = "wasm"))]
impl LineMirror for firmware_demo::host::BoardChip {
    fn begin(
        &mut self,
        params: &BaseParams<f32>,
        start: Pose<f32>,
        decimate: u16,
    ) -> Result<(), MirrorError> {
        Ok(Self::begin(self, params, start, decimate)?)
    }

    fn tick(
        &mut self,
        line: &[u8],
        now_us: u32,
        sensed: &Sensed<f32>,
    ) -> Result<(WheelOutput, Vec<u8>), MirrorError> {
        self.receive(line)?;
        Ok(Self::tick(self, now_us, sensed)?)
    }
}
