//! From the action of a tick to the wheels.

use super::controller::BaseController;
use super::io::WheelAction;
use crate::hal::{Error as _, ErrorKind, WheelDrive};
use crate::maths::Maths;
use crate::shunting::NeuronUpdate;
use crate::types::WheelTorques;

impl<M: Maths<f32>, U: NeuronUpdate<f32>, const N: usize> BaseController<f32, M, U, N> {
    /// Has the wheels do what the last [`tick`](Self::tick) or [`emergency_stop`](Self::emergency_stop) asks of them, at a supply of `supply_v`
    /// where that is measured \[V\]. What the driver exerts instead of its command is [noted](Self::note_exerted). After an error the wheels' state is
    /// unknown, and they are released.
    ///
    /// # Errors
    /// What the driver answers: the next tick's [`Sensed::driver`](super::Sensed::driver).
    pub fn apply<D: WheelDrive>(
        &mut self,
        drive: &mut D,
        supply_v: Option<f32>,
    ) -> Result<(), ErrorKind> {
        let action = &self.report().action;
        let applied = match action {
            WheelAction::Drive(command) => {
                drive.observe(&command.observed(supply_v));
                drive.set_torques(command.torques)
            }
            WheelAction::Brake => drive.brake(),
            WheelAction::Release => drive.release(),
        };
        let answer = applied.map_err(|error| error.kind());
        let exerted = if answer.is_err() {
            if *action != WheelAction::Release {
                // If this fails too there is nothing left to do now; every tick from here on tries again.
                let _ = drive.release();
            }
            Some(WheelTorques::default())
        } else if action.torques().is_some() {
            drive.exerted()
        } else {
            None
        };
        if let Some(exerted) = exerted {
            // What is no number is not noted: the estimates go on with the commanded torques.
            let _ = self.note_exerted(&exerted);
        }
        answer
    }
}
